// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/paths/patches.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "geometry/numbers/grid_vector.hpp"
#include "geometry/steps/stop.hpp"
#include "geometry/tubes/mirror.hpp"

// Cuts visible polygons into triangles and joins the triangles in one cube of a facet to a patch. Solid
// angles are exact (van Oosterom & Strackee 1983), and so are projected solid angles (Lambert 1760).

namespace tubefoot {
namespace {

constexpr double most_patches = 1e8;

using Triangle = std::array<glm::dvec3, 3>;

/// Index k of the longest edge, which leads from corner k to the next one.
std::size_t longest_edge(const Triangle& t, double& length) {
  std::size_t longest = 0;
  length = -1;
  for (std::size_t k = 0; k < 3; ++k)
    if (const double l = glm::distance(t[k], t[(k + 1) % 3]); l > length) {
      length = l;
      longest = k;
    }
  return longest;
}

/// Solid angle of a triangle from the origin, at the given distance from its plane (van Oosterom & Strackee
/// 1983).
double triangle_sr(const Triangle& t, double area, double plane_distance) {
  const double a = glm::length(t[0]), b = glm::length(t[1]), c = glm::length(t[2]);
  return 2 * std::atan2(2 * area * plane_distance, a * b * c + glm::dot(t[0], t[1]) * c +
                                                       glm::dot(t[1], t[2]) * a + glm::dot(t[2], t[0]) * b);
}

/// Integral of the cosine to an axis over the solid angle of a triangle. Each edge contributes half the
/// angle that it subtends at the origin, times a cosine. This is the cosine between the axis and the normal
/// of the plane through origin and edge (Lambert 1760).
double projected_solid_angle(const Triangle& t, glm::dvec3 axis) {
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::dvec3 &a = t[k], &b = t[(k + 1) % 3], normal = glm::cross(a, b);
    const double length = glm::length(normal);
    if (length > 0) sum += std::atan2(length, glm::dot(a, b)) * glm::dot(normal, axis) / length;
  }
  return sum / 2;
}

}  // namespace

GridPoint in_front(const FacetMesh& mesh, FacetId facet, GridPoint apex, glm::dvec3 place, glm::dvec3 normal,
                   double least) {
  MirrorPlane plane = MirrorPlane::of_facet(mesh, facet, apex);
  if (glm::dot(plane.unit_normal(), normal) < 0) {  // rays may arrive at the side opposite to the apex
    plane.normal = {-plane.normal.x, -plane.normal.y, -plane.normal.z};
    plane.offset = -plane.offset;
  }
  for (double lift = least;; lift = lift == 0 ? 1 : 2 * lift) {
    const glm::dvec3 p = place + lift * normal;
    const GridPoint at{apex.x + static_cast<std::int32_t>(std::lround(p.x)),
                       apex.y + static_cast<std::int32_t>(std::lround(p.y)),
                       apex.z + static_cast<std::int32_t>(std::lround(p.z))};
    if (plane.side(at) > 0) return at;
  }
}

std::vector<RadiosityPatch> patches_of(const FacetMesh& mesh, GridPoint apex, const VisibleSurface& seabed,
                                       double unit_m, double longest_m,
                                       std::span<const std::uint32_t> label_of_tube, glm::dvec3 axis) {
  const SharedFootprints& seen = seabed.shared;
  double about = 0;
  for (const SharedPiece& piece : seen.pieces)
    for (std::uint32_t k = 2; k < piece.count; ++k) {
      double length = 0;
      longest_edge(
          {seen.corners_m[piece.first], seen.corners_m[piece.first + k - 1], seen.corners_m[piece.first + k]},
          length);
      about += std::max(1.0, length * length / (longest_m * longest_m));
    }
  if (about > most_patches)
    throw std::length_error(
        fmt::format("patches of {:.3g} m need about {:.2g} patches, more than {:.2g}: use larger patches",
                    longest_m, about, most_patches));
  std::vector<RadiosityPatch> patches;
  std::vector<Triangle> left;
  // A facet has one entry per tube that sees it.
  std::vector<const SharedFacet*> by_facet;
  for (const SharedFacet& facet : seen.facets) by_facet.push_back(&facet);
  std::stable_sort(by_facet.begin(), by_facet.end(),
                   [](const SharedFacet* a, const SharedFacet* b) { return a->facet < b->facet; });
  std::map<std::array<std::int64_t, 5>, RadiosityPatch> gathered;  // key: side, label and cube
  for (auto first = by_facet.begin(), end = first; first != by_facet.end(); first = end) {
    const FacetId id = (*first)->facet;
    std::vector<std::pair<const SharedFacet*, const SharedPiece*>> pieces;
    for (; end != by_facet.end() && (*end)->facet == id; ++end)
      for (std::uint32_t i = 0; i < (*end)->piece_count; ++i)
        pieces.emplace_back(*end, &seen.pieces[(*end)->first_piece + i]);
    const auto normal_of = [&](const SharedFacet& facet) {
      const RefractedFacet* refracted = seabed.refracted_of(facet);
      return refracted != nullptr ? refracted->normal : facet.plane_normal;
    };
    const glm::dvec3 first_normal = normal_of(**first);
    glm::dvec3 corner(std::numeric_limits<double>::infinity());
    for (const VertexId v : mesh.facets[id]) {
      const GridPoint p = mesh.vertices[v];
      corner = glm::min(corner, displacement_m(apex, p, unit_m));
    }
    gathered.clear();
    for (const auto& [seen_part, seen_piece] : pieces) {
      stop_if_wanted();
      const SharedPiece& piece = *seen_piece;
      const RefractedFacet* refracted = seabed.refracted_of(*seen_part);
      const SharedFacet& part = refracted != nullptr ? *seen_part : **first;
      const glm::dvec3 normal = normal_of(part);
      const bool other_side = glm::dot(normal, first_normal) < 0;
      for (std::uint32_t k = 2; k < piece.count; ++k)
        left.push_back({seen.corners_m[piece.first], seen.corners_m[piece.first + k - 1],
                        seen.corners_m[piece.first + k]});
      while (!left.empty()) {
        const Triangle t = left.back();
        left.pop_back();
        double length = 0;
        const std::size_t k = longest_edge(t, length);
        if (length > longest_m) {
          const glm::dvec3 middle = (t[k] + t[(k + 1) % 3]) * 0.5;
          left.push_back({t[k], middle, t[(k + 2) % 3]});
          left.push_back({middle, t[(k + 1) % 3], t[(k + 2) % 3]});
          continue;
        }
        const double seen_m2 = glm::length(glm::cross(t[1] - t[0], t[2] - t[0])) / 2;
        if (!(seen_m2 > 0)) continue;
        const double area_m2 = refracted != nullptr ? refracted->area_ratio * seen_m2 : seen_m2;
        const glm::dvec3 middle = (t[0] + t[1] + t[2]) / 3.0,
                         lies = refracted != nullptr ? refracted->lies.at(middle) : middle,
                         cube = glm::floor((lies - corner) * (2 / longest_m) + 1e-3);
        const std::int64_t label = label_of_tube.empty() ? 0 : label_of_tube[piece.transmit_tube];
        RadiosityPatch& patch = gathered[{std::int64_t(other_side), label, std::int64_t(cube.x),
                                          std::int64_t(cube.y), std::int64_t(cube.z)}];
        patch.cube = {std::int64_t(cube.x), std::int64_t(cube.y), std::int64_t(cube.z)};
        patch.tube = piece.transmit_tube;
        if (patch.area_m2 == 0) patch.absorbed = 0;
        patch.normal = normal;
        patch.from_apex_m += area_m2 * middle;  // sums until all triangles are added
        patch.lies_m += area_m2 * lies;
        if (refracted != nullptr) {
          const RefractedFacet::Ray ray = refracted->ray_to(lies);
          patch.sine += area_m2 * refracted->sine(middle, ray);
          patch.absorbed += area_m2 * ray.absorbed;
        } else {
          patch.sine = part.transmit_distance_m;  // divided by the range below
        }
        patch.area_m2 += area_m2;
        patch.solid_angle_sr += triangle_sr(t, seen_m2, part.transmit_distance_m);
        if (axis != glm::dvec3(0)) patch.projected_sr += std::abs(projected_solid_angle(t, axis));
      }
    }
    for (auto& [key, patch] : gathered) {
      patch.facet = id;
      patch.from_apex_m /= patch.area_m2;
      patch.lies_m /= patch.area_m2;
      patch.sine /= seabed.refracted.empty() ? glm::length(patch.from_apex_m) : patch.area_m2;
      patch.absorbed = seabed.refracted.empty() ? 1 : patch.absorbed / patch.area_m2;
      patches.push_back(patch);
    }
  }
  return patches;
}

TubeSet front_tubes(GridPoint from, glm::dvec3 normal, double reach) {
  constexpr double right_angle = std::numbers::pi / 2, cap = 1e-3;
  constexpr int cells = 2;
  const glm::dvec3 n = normal;
  const glm::dvec3 aside = std::abs(n.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 u = glm::normalize(glm::cross(n, aside));
  AngularGrid grid;
  for (int k = 0; k <= cells; ++k) {
    const double turn = 2.0 * k / cells - 1;
    grid.azimuth_edges_rad.push_back(turn * right_angle);
    grid.elevation_edges_rad.push_back(turn * (right_angle - cap));
  }
  grid.frame = glm::dmat3(n, glm::cross(u, n), u);
  TubeSet tubes;
  tubes.apex = from;
  tubes.reach = reach;
  append_tubes(tubes, grid);
  return tubes;
}

}  // namespace tubefoot
