// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/footprints/footprint_builder.hpp"

#include <cmath>
#include <glm/glm.hpp>

#include "geometry/arithmetic/exact_corner.hpp"

namespace tubefoot {
namespace {

void append_open_pieces(const NameContext& context, std::uint32_t tube, const TubeVisibility& seen,
                        FootprintSet& set) {
  for (const NamedPiece& piece : seen.open) {
    set.open_pieces.push_back({tube, static_cast<std::uint32_t>(set.open_directions.size()), piece.count});
    for (std::uint32_t c = 0; c < piece.count; ++c)
      set.open_directions.push_back(glm::normalize(direction_of(context, seen.corners[piece.first + c])));
  }
}

}  // namespace

void append_footprints(const FacetMesh& mesh, const TubeSet& tubes, std::uint32_t tube,
                       const TubeVisibility& seen, double unit_m, FootprintSet& set, bool corner_names) {
  const NameContext context{mesh, tubes.apex, seen.rays};
  const auto first_ray = static_cast<std::uint32_t>(set.name_rays.size());
  if (corner_names) set.name_rays.insert(set.name_rays.end(), seen.rays.begin(), seen.rays.end());
  append_open_pieces(context, tube, seen, set);
  auto occluder = seen.occluders.begin();
  for (std::size_t k = 0; k < seen.pieces.size();) {
    const FacetId facet = seen.pieces[k].facet;
    FacetCone cone;
    FacetCone::make(mesh, facet, tubes.apex, cone);
    const glm::dvec3 normal(cone.normal.x, cone.normal.y, cone.normal.z);
    const double length = glm::length(normal);

    Footprint footprint;
    footprint.facet = facet;
    footprint.tube = tube;
    footprint.plane_normal = -normal / length;
    footprint.plane_distance_m = static_cast<double>(cone.offset) / length * unit_m;
    footprint.first_piece = static_cast<std::uint32_t>(set.pieces.size());
    for (; k < seen.pieces.size() && seen.pieces[k].facet == facet; ++k) {
      const NamedPiece& piece = seen.pieces[k];
      const auto first = static_cast<std::uint32_t>(set.corners_m.size());
      bool finite = true;
      for (std::uint32_t c = 0; c < piece.count; ++c) {
        set.corners_m.push_back(point_on_facet(context, seen.corners[piece.first + c], cone) * unit_m);
        finite = finite && std::isfinite(glm::dot(set.corners_m.back(), glm::dvec3(1)));
      }
      if (finite)
        set.pieces.push_back({first, piece.count});
      else  // a corner of two coincident planes, which occurs in plain double but never with exact signs
        set.corners_m.resize(first);
      if (finite && corner_names)
        for (std::uint32_t c = 0; c < piece.count; ++c)
          set.corner_names.push_back(moved(seen.corners[piece.first + c], first_ray));
    }
    footprint.piece_count = static_cast<std::uint32_t>(set.pieces.size()) - footprint.first_piece;

    footprint.first_occluder = static_cast<std::uint32_t>(set.occluders.size());
    while (occluder != seen.occluders.end() && occluder->first < facet)
      ++occluder;  // occluders of facets that are not seen
    for (; occluder != seen.occluders.end() && occluder->first == facet; ++occluder)
      set.occluders.push_back(occluder->second);
    footprint.occluder_count = static_cast<std::uint32_t>(set.occluders.size()) - footprint.first_occluder;
    set.footprints.push_back(footprint);
  }
}

FootprintSet joined(std::span<const FootprintSet> sets) {
  std::size_t footprints = 0, pieces = 0, corners = 0, occluders = 0;
  for (const FootprintSet& set : sets) {
    footprints += set.footprints.size();
    pieces += set.pieces.size();
    corners += set.corners_m.size();
    occluders += set.occluders.size();
  }
  FootprintSet all;
  all.footprints.reserve(footprints);
  all.pieces.reserve(pieces);
  all.corners_m.reserve(corners);
  all.occluders.reserve(occluders);
  for (const FootprintSet& set : sets) {
    const auto first_piece = static_cast<std::uint32_t>(all.pieces.size()),
               first_corner = static_cast<std::uint32_t>(all.corners_m.size()),
               first_occluder = static_cast<std::uint32_t>(all.occluders.size());
    for (Footprint footprint : set.footprints) {
      footprint.first_piece += first_piece;
      footprint.first_occluder += first_occluder;
      all.footprints.push_back(footprint);
    }
    for (Piece piece : set.pieces) {
      piece.first += first_corner;
      all.pieces.push_back(piece);
    }
    all.corners_m.insert(all.corners_m.end(), set.corners_m.begin(), set.corners_m.end());
    const auto first_ray = static_cast<std::uint32_t>(all.name_rays.size()),
               first_direction = static_cast<std::uint32_t>(all.open_directions.size());
    for (const CornerName& name : set.corner_names) all.corner_names.push_back(moved(name, first_ray));
    all.name_rays.insert(all.name_rays.end(), set.name_rays.begin(), set.name_rays.end());
    for (OpenPiece piece : set.open_pieces) {
      piece.first += first_direction;
      all.open_pieces.push_back(piece);
    }
    all.open_directions.insert(all.open_directions.end(), set.open_directions.begin(),
                               set.open_directions.end());
    all.occluders.insert(all.occluders.end(), set.occluders.begin(), set.occluders.end());
  }
  return all;
}

}  // namespace tubefoot
