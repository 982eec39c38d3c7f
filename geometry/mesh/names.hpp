// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <utility>

#include "geometry/mesh/facet_mesh.hpp"

// Names of points, planes and corners as seen from one apex. The kernel determines the topology, and its
// result is a list of names. Any arithmetic can compute the point of a name (exact_corner.hpp). The kernel
// never uses computed coordinates as input.
namespace tubefoot {

/// A mesh vertex, or a ray of the tube or of a plane that split the tube. Rays have the top bit set.
using PointId = std::uint32_t;
constexpr PointId ray_bit = 0x80000000u;
constexpr PointId no_point = 0xffffffffu;

/// A plane through the apex. Its normal is a x b for points a < b. For a depth plane it is c_i n_j - c_j n_i
/// for facets i = a, j = b. On a depth plane the two facets' planes have equal depth along each ray.
struct PlaneName {
  std::uint32_t a = no_point, b = no_point;
  bool depth = false;
  friend bool operator==(const PlaneName&, const PlaneName&) = default;

  /// Returns true if the plane contains the ray through that point, by name alone.
  bool contains(PointId p) const { return !depth && (a == p || b == p); }
};

/// A corner of a convex cone: the ray through a point, or sign * (normal of p x normal of q).
struct CornerName {
  PointId point = no_point;
  PlaneName p, q;
  int sign = 1;
};

}  // namespace tubefoot
