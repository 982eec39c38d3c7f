// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/vertical_line.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "geometry/wide_int.hpp"

namespace tubefoot {
namespace {

/// Sign of the turn a, b, p in the plan, with p moved by (epsilon, epsilon^2): never 0 unless a = b.
int turn(GridPoint a, GridPoint b, GridPoint p) {
  const Int128 dx = Int128(b.x) - a.x, dy = Int128(b.y) - a.y;
  if (const int s = sign(dx * (Int128(p.y) - a.y) - dy * (Int128(p.x) - a.x))) return s;
  if (dy != 0) return -sign(dy);
  return sign(dx);
}

/// How far above a point a facet is crossed, as numerator and denominator of one sign with it.
struct Crossing {
  bool exists = false;
  Int128 height, scale;
};

Crossing crossing(const FacetMesh& mesh, FacetId id, GridPoint point) {
  std::array<GridPoint, 3> v;
  for (int k = 0; k < 3; ++k) v[k] = mesh.vertices[mesh.facets[id][k]];
  const int s0 = turn(v[0], v[1], point), s1 = turn(v[1], v[2], point), s2 = turn(v[2], v[0], point);
  if (s0 != s1 || s1 != s2) return {};
  // Plane n . (x - v0) = 0 with n_z of the sign of the turns; the point is above it where n . (p - v0) n_z
  // > 0.
  const Int128 ax = Int128(v[1].x) - v[0].x, ay = Int128(v[1].y) - v[0].y, az = Int128(v[1].z) - v[0].z,
               bx = Int128(v[2].x) - v[0].x, by = Int128(v[2].y) - v[0].y, bz = Int128(v[2].z) - v[0].z;
  const Int128 nx = ay * bz - az * by, ny = az * bx - ax * bz, nz = ax * by - ay * bx;
  const Int128 above =
      nx * (Int128(point.x) - v[0].x) + ny * (Int128(point.y) - v[0].y) + nz * (Int128(point.z) - v[0].z);
  return {nz != 0, -above, nz};  // a vertical facet: the moved line passes beside it
}

}  // namespace

void facets_near_vertical(const SceneTree& tree, GridPoint point, std::vector<FacetId>& out) {
  facets_near_vertical(tree, point, 0, out);
}

void facets_near_vertical(const SceneTree& tree, GridPoint point, double margin, std::vector<FacetId>& out) {
  constexpr std::array<SceneTree::HalfSpace, 4> vertical{{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}}};
  tree.query(point, vertical, std::numeric_limits<double>::infinity(), margin, out);
}

int vertical_side(const FacetMesh& mesh, FacetId facet, GridPoint point) {
  const Crossing c = crossing(mesh, facet, point);
  return !c.exists ? 0 : sign(c.height) * sign(c.scale) > 0 ? 1 : -1;
}

std::vector<VerticalCrossings> vertical_crossings(const FacetMesh& mesh, const SceneTree& tree,
                                                  GridPoint point) {
  std::vector<FacetId> candidates;
  facets_near_vertical(tree, point, candidates);
  std::vector<VerticalCrossings> all;
  for (const FacetId id : candidates) {
    const Crossing c = crossing(mesh, id, point);
    if (!c.exists) continue;
    const std::uint16_t component = mesh.component[id];
    auto entry =
        std::find_if(all.begin(), all.end(), [&](const auto& e) { return e.component == component; });
    if (entry == all.end())
      entry = all.insert(all.end(), {component, 0, 0, std::numeric_limits<double>::infinity(),
                                     std::numeric_limits<double>::infinity()});
    const double height = static_cast<double>(c.height) / static_cast<double>(c.scale);
    if (sign(c.height) * sign(c.scale) > 0) {
      ++entry->above;
      entry->lowest_above = std::min(entry->lowest_above, height);
    } else {
      ++entry->below;
      entry->highest_below = std::min(entry->highest_below, -height);
    }
  }
  return all;
}

}  // namespace tubefoot
