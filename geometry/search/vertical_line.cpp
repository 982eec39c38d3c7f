// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/search/vertical_line.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "geometry/numbers/int128.hpp"

// Counts the crossings of a vertical line with facets in 128-bit integers. The line is displaced by (epsilon,
// epsilon^2) in the plan, so that it meets no edge and no vertex.

namespace tubefoot {
namespace {

/// Returns the sign of the turn a, b, p in the plan, with p moved by (epsilon, epsilon^2). The sign is 0 only
/// if a = b.
int turn(GridPoint a, GridPoint b, GridPoint p) {
  const Int128 dx = Int128(b.x) - a.x, dy = Int128(b.y) - a.y;
  if (const int s = sign(dx * (Int128(p.y) - a.y) - dy * (Int128(p.x) - a.x))) return s;
  if (dy != 0) return -sign(dy);
  return sign(dx);
}

/// Height of a crossing above a point, as numerator and denominator. The sign of their product is the sign of
/// the height.
struct Crossing {
  bool exists = false;
  Int128 height, scale;
};

Crossing crossing(const FacetMesh& mesh, FacetId id, GridPoint point) {
  std::array<GridPoint, 3> v;
  for (int k = 0; k < 3; ++k) v[k] = mesh.vertices[mesh.facets[id][k]];
  const int s0 = turn(v[0], v[1], point), s1 = turn(v[1], v[2], point), s2 = turn(v[2], v[0], point);
  if (s0 != s1 || s1 != s2) return {};
  // The plane is n . (x - v0) = 0 with n_z of the sign of the turns. The point is above it if n . (p - v0)
  // n_z > 0.
  const Int128 ax = Int128(v[1].x) - v[0].x, ay = Int128(v[1].y) - v[0].y, az = Int128(v[1].z) - v[0].z,
               bx = Int128(v[2].x) - v[0].x, by = Int128(v[2].y) - v[0].y, bz = Int128(v[2].z) - v[0].z;
  const Int128 nx = ay * bz - az * by, ny = az * bx - ax * bz, nz = ax * by - ay * bx;
  const Int128 above =
      nx * (Int128(point.x) - v[0].x) + ny * (Int128(point.y) - v[0].y) + nz * (Int128(point.z) - v[0].z);
  return {nz != 0, -above, nz};  // a vertical facet: the displaced line passes outside of it
}

struct Vector128 {
  Int128 x, y, z;
};

Vector128 between(GridPoint from, GridPoint to) {
  return {Int128(to.x) - from.x, Int128(to.y) - from.y, Int128(to.z) - from.z};
}
Vector128 cross(const Vector128& a, const Vector128& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Compares a vector along a facet's normal with the normal: 1 for the same direction, -1 for the opposite, 0
/// for a zero vector. The sign is taken along an axis on which the normal is not zero.
int sense(const Vector128& turn, const Vector128& normal) {
  if (normal.x != 0) return sign(turn.x) * sign(normal.x);
  if (normal.y != 0) return sign(turn.y) * sign(normal.y);
  return sign(turn.z) * sign(normal.z);
}

}  // namespace

std::optional<FacetContact> contact_at(const FacetMesh& mesh, std::span<const FacetId> near,
                                       GridPoint point) {
  std::optional<FacetContact> found;
  FacetId lowest = 0;
  for (const FacetId id : near) {
    std::array<GridPoint, 3> v;
    for (int k = 0; k < 3; ++k) v[k] = mesh.vertices[mesh.facets[id][k]];
    const auto [low, high] = std::minmax({v[0].z, v[1].z, v[2].z});
    if (point.z < low || point.z > high || (found && id > lowest)) continue;
    const Vector128 normal = cross(between(v[0], v[1]), between(v[0], v[2])), to_point = between(v[0], point);
    if (normal.x == 0 && normal.y == 0 && normal.z == 0) continue;
    if (normal.x * to_point.x + normal.y * to_point.y + normal.z * to_point.z != 0) continue;
    int edges = 0;
    bool outside = false;
    for (int k = 0; k < 3; ++k) {
      const int side = sense(cross(between(v[k], v[(k + 1) % 3]), between(v[k], point)), normal);
      outside = outside || side < 0;
      edges += side == 0;
    }
    if (outside) continue;
    using Part = FacetContact::Part;
    lowest = id;
    found = FacetContact{edges == 0   ? Part::facet
                         : edges == 1 ? Part::edge
                                      : Part::vertex,
                         mesh.component[id]};
  }
  return found;
}

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

std::vector<VerticalCrossings> vertical_crossings(const FacetMesh& mesh, std::span<const FacetId> near,
                                                  GridPoint point) {
  std::vector<VerticalCrossings> all;
  for (const FacetId id : near) {
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

bool is_enclosed(const FacetMesh& mesh, const ClosedShells& shells, std::span<const FacetId> near,
                 GridPoint point) {
  std::vector<std::uint32_t> crossed;
  for (const FacetId id : near)
    if (const auto shell = shells.shell_of(id); shell && vertical_side(mesh, id, point) > 0)
      crossed.push_back(*shell);
  std::ranges::sort(crossed);
  for (auto first = crossed.begin(); first != crossed.end();) {
    const auto end = std::upper_bound(first, crossed.end(), *first);
    if ((end - first) % 2 == 1) return true;
    first = end;
  }
  return false;
}

}  // namespace tubefoot
