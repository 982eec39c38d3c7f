// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/signal/view_displacement.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <limits>
#include <numbers>

// Bounds the effect of rounding a mesh's vertices to the grid of a view, from displacements of vertices,
// slopes of facets and lengths of borders. Source: docs/notes/smooth-surfaces.md, "Bounds".

namespace tubefoot {
namespace {

// Margins for several roundings in doubles: a factor for sums of non-negative quantities, and a relative
// error of coordinates no larger than a radius.
constexpr double upwards = 1 + 1e-9, coordinate_slack = 1e-14;

/// Twice the vector area of a facet; its z is twice the signed area of the projection.
glm::dvec3 twice_facet(const std::vector<glm::dvec3>& at, const std::array<std::uint32_t, 3>& t) {
  return glm::cross(at[t[1]] - at[t[0]], at[t[2]] - at[t[0]]);
}

/// Bound of the change of the distance per length across the line of sight.
double slope_of(glm::dvec3 twice, double slack) {
  const double over = std::abs(twice.z) - slack;
  return over > 0 ? (std::hypot(twice.x, twice.y) + slack) / over : std::numeric_limits<double>::infinity();
}

}  // namespace

ViewDisplacement::ViewDisplacement(const FarViewGrid& grid, std::span<const glm::dvec3> points_m,
                                   std::span<const std::array<std::uint32_t, 3>> triangles,
                                   const PlacedEdges& edges, const EnclosedAxes& axes) {
  // Positions relative to the middle of the body: true, and on the grid.
  std::vector<glm::dvec3> there(points_m.size()), snapped(points_m.size());
  const Ball unit(std::ldexp(1.0, -FarViewGrid::exponent)), height(FarViewGrid::apex_height);
  const std::array<Ball, 3> middle{grid.middle_m.x, grid.middle_m.y, grid.middle_m.z};
  for (std::size_t k = 0; k < points_m.size(); ++k) {
    const std::array<Ball, 3> from{Ball(points_m[k].x) - middle[0], Ball(points_m[k].y) - middle[1],
                                   Ball(points_m[k].z) - middle[2]};
    const GridPoint& g = grid.vertices[k];
    const std::array<Ball, 3> mapped{Ball(g.x) * unit, Ball(g.y) * unit, Ball(g.z) * unit};
    const Ball scale = Ball(grid.radius_m) * height / (height - mapped[2]);
    std::array<Ball, 3> moved;
    for (int i = 0; i < 3; ++i) {
      const std::array<Ball, 3>& axis = axes[static_cast<std::size_t>(i)];
      const Ball before = axis[0] * from[0] + axis[1] * from[1] + axis[2] * from[2],
                 after = scale * mapped[static_cast<std::size_t>(i)];
      moved[static_cast<std::size_t>(i)] = after - before;
      there[k][i] = before.middle();
      snapped[k][i] = after.middle();
    }
    across_ = std::max(across_, root(squared(moved[0]) + squared(moved[1])).hi());
    towards_ = std::max({towards_, std::abs(moved[2].lo()), std::abs(moved[2].hi())});
  }

  const double radius = grid.radius_m, slack = coordinate_slack * radius * radius,
               disc = std::numbers::pi * across_ * across_;
  std::vector<int> side(triangles.size());  // visible side; 0: not certainly the same for both meshes
  for (std::size_t facet = 0; facet < triangles.size(); ++facet) {
    const std::array<std::uint32_t, 3>& t = triangles[facet];
    const glm::dvec3 before = twice_facet(there, t), after = twice_facet(snapped, t);
    if (std::min(before.z, after.z) > slack)
      side[facet] = 1;
    else if (std::max(before.z, after.z) < -slack)
      side[facet] = -1;
    double perimeter = 0;
    for (std::size_t k = 0; k < 3; ++k)
      perimeter += glm::length(glm::dvec2(there[t[(k + 1) % 3]]) - glm::dvec2(there[t[k]])) +
                   coordinate_slack * radius;
    slanted_.push_back({std::max(slope_of(before, slack), slope_of(after, slack)),
                        (std::abs(before.z) + slack) / 2 + 2 * across_ * perimeter + 4 * disc});
  }
  border_m2_ = 9 * disc * static_cast<double>(points_m.size());
  for (const PlacedEdges::Edge& edge : edges.edges) {
    const double length =
        glm::length(glm::dvec2(there[edge.to]) - glm::dvec2(there[edge.from])) + coordinate_slack * radius;
    const double within = 6 * across_ * length + 9 * disc;
    const int one = side[edge.facets[0]], other = side[edge.facets[1]];
    // Facets lie on either side of an edge if they have the same orientation and traverse the edge in
    // opposite directions.
    const bool inner = edge.is_shared && one != 0 && other != 0 && (one == other) != edge.same_way;
    if (inner)
      inner_.push_back({edge.facets, within});
    else
      border_m2_ += within;
  }
}

double ViewDisplacement::bound_m2(double k, double area_m2, double largest,
                                  std::span<const ComplexBall> factors) const {
  // The phase changes by 2k per metre. Two numbers of modulus 1 differ by at most 2.
  double changed = 2 * k * towards_ * area_m2 + 2 * border_m2_;
  for (const Slanted& facet : slanted_)
    changed += std::min(2.0, 2 * k * across_ * facet.slope) * facet.area_m2;
  changed *= largest;
  if (!factors.empty())
    for (const Inner& edge : inner_)
      changed += (factors[edge.facets[0]] - factors[edge.facets[1]]).largest() * edge.area_m2;
  return changed * upwards;
}

}  // namespace tubefoot
