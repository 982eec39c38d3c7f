// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/footprints/footprint_builder.hpp"

#include <cmath>
#include <glm/glm.hpp>

#include "geometry/arithmetic/exact_corner.hpp"

namespace tubefoot {

void append_footprints(const FacetMesh& mesh, const TubeSet& tubes, std::uint32_t tube,
                       const TubeVisibility& seen, double unit_m, FootprintSet& set) {
  const NameContext context{mesh, tubes.apex, seen.rays};
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
    all.occluders.insert(all.occluders.end(), set.occluders.begin(), set.occluders.end());
  }
  return all;
}

}  // namespace tubefoot
