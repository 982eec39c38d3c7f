// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/footprints/shadow_borders.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "geometry/arithmetic/exact_corner.hpp"
#include "geometry/footprints/piece_walls.hpp"

// Finds shadow borders by the names of corners. Two corners of a piece are the ends of a border if they share
// the plane of another facet's edge in front of it.

namespace tubefoot {
namespace {

glm::dvec3 vector_of(const GridPoint& p) { return {p.x, p.y, p.z}; }

/// Returns whether the names are those of an edge of another facet.
bool is_foreign_edge(const PlaneName& plane, const std::array<VertexId, 3>& own) {
  if (plane.depth || ((plane.a | plane.b) & ray_bit)) return false;
  const auto has = [&](PointId p) { return std::find(own.begin(), own.end(), p) != own.end(); };
  return !has(plane.a) || !has(plane.b);
}

}  // namespace

std::vector<ShadowBorder> shadow_borders(const FacetMesh& mesh, const TubeSet& tubes,
                                         std::span<const TubeVisibility> seen) {
  constexpr double rounding = 1e-9;
  std::vector<ShadowBorder> borders;
  for (const TubeVisibility& tube : seen) {
    const NameContext context{mesh, tubes.apex, tube.rays};
    for (const NamedPiece& piece : tube.pieces) {
      FacetCone facet;
      if (!FacetCone::make(mesh, piece.facet, tubes.apex, facet)) continue;
      const glm::dvec3 across_facet =
          glm::normalize(glm::dvec3(static_cast<double>(facet.normal.x), static_cast<double>(facet.normal.y),
                                    static_cast<double>(facet.normal.z)));
      for (std::uint32_t k = 0; k < piece.count; ++k) {
        const CornerName &first = tube.corners[piece.first + k],
                         &second = tube.corners[piece.first + (k + 1) % piece.count];
        const auto plane = shared_plane(first, second);
        if (!plane || !is_foreign_edge(*plane, facet.vertex)) continue;
        const glm::dvec3 a = vector_of(context.point(plane->a)), b = vector_of(context.point(plane->b)),
                         begin = point_on_facet(context, first, facet),
                         end = point_on_facet(context, second, facet), normal = glm::cross(a, b);
        // The ray to a point meets the line of the edge at a + share (b - a).
        const auto slope = [&](glm::dvec3 point) { return glm::dot(glm::cross(b - a, point), normal); };
        const auto share_of = [&](glm::dvec3 point) {
          return -glm::dot(glm::cross(a, point), normal) / slope(point);
        };
        const auto on_edge = [&](double share) { return a + share * (b - a); };
        const auto on_facet = [&](double share) {
          return on_edge(share) * (glm::dot(begin, across_facet) / glm::dot(on_edge(share), across_facet));
        };
        const auto add = [&](glm::dvec3 first_point, glm::dvec3 last_point) {
          // Beyond the ends of the edge, its plane only divides pieces.
          const auto [low, high] = std::minmax(
              {std::clamp(share_of(first_point), 0.0, 1.0), std::clamp(share_of(last_point), 0.0, 1.0)});
          if (!(high - low > rounding)) return;
          const glm::dvec3 from = on_facet(low), to = on_facet(high), middle = (from + to) / 2.0;
          const double range = glm::length(middle), to_edge = glm::length(on_edge(share_of(middle)));
          if (!(to_edge < range * (1 - rounding))) return;
          borders.push_back({glm::distance(from, to), to_edge, range - to_edge,
                             glm::length(glm::cross(across_facet, glm::normalize(normal)))});
        };
        if (slope(begin) * slope(end) > 0) {
          add(begin, end);
          continue;
        }
        // A ray between them is parallel to the edge.
        const double parallel = slope(begin) / (slope(begin) - slope(end));
        if (parallel > rounding) add(begin, begin + (parallel - rounding) * (end - begin));
        if (parallel < 1 - rounding) add(begin + (parallel + rounding) * (end - begin), end);
      }
    }
  }
  return borders;
}

}  // namespace tubefoot
