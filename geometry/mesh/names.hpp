// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <utility>

#include "geometry/mesh/facet_mesh.hpp"

// Names of points, planes and corners as seen from one apex. The kernel decides topology; a result is a list
// of names, from which any arithmetic can compute the same point (exact_corner.hpp). No coordinate is ever
// fed back.
namespace tubefoot {

/// A mesh vertex, or a ray of the tube (or of a plane that split it): rays carry the top bit.
using PointId = std::uint32_t;
constexpr PointId ray_bit = 0x80000000u;
constexpr PointId no_point = 0xffffffffu;

/// A plane through the apex. Its normal is a x b (points a < b), or c_i n_j - c_j n_i (facets i = a, j = b)
/// for a depth plane, on which the depths of the facets' planes along a ray are equal.
struct PlaneName {
  std::uint32_t a = no_point, b = no_point;
  bool depth = false;
  friend bool operator==(const PlaneName&, const PlaneName&) = default;

  /// True where the plane contains the ray through that point, by name alone.
  bool contains(PointId p) const { return !depth && (a == p || b == p); }
};

/// A corner of a convex cone: the ray through a point, or sign * (normal of p x normal of q).
struct CornerName {
  PointId point = no_point;
  PlaneName p, q;
  int sign = 1;
};

}  // namespace tubefoot
