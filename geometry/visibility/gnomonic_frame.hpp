// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/glm.hpp>
#include <limits>

#include "geometry/mesh/facet_cone.hpp"

// Positions of facets in the gnomonic plane of a tube, in double precision. They only determine tests that
// can be skipped, always with a margin beyond rounding. Exact signs alone determine the visible polygons.
namespace tubefoot {

inline glm::dvec3 as_double(GridPoint p) { return {p.x, p.y, p.z}; }

/// A box in a gnomonic plane.
struct Bounds {
  double x0, x1, y0, y1;
  static Bounds nothing() {
    constexpr double inf = std::numeric_limits<double>::infinity();
    return {inf, -inf, inf, -inf};
  }
  static Bounds everything() {
    constexpr double inf = std::numeric_limits<double>::infinity();
    return {-inf, inf, -inf, inf};
  }
  bool meets(const Bounds& o) const { return x0 <= o.x1 && o.x0 <= x1 && y0 <= o.y1 && o.y0 <= y1; }
  bool is_finite() const {
    return std::isfinite(x0) && std::isfinite(x1) && std::isfinite(y0) && std::isfinite(y1);
  }
  void add(glm::dvec2 p) {
    x0 = std::min(x0, p.x);
    x1 = std::max(x1, p.x);
    y0 = std::min(y0, p.y);
    y1 = std::max(y1, p.y);
  }
  void widen(double margin) {
    x0 -= margin;
    x1 += margin;
    y0 -= margin;
    y1 += margin;
  }
};

/// The plane axis . d = 1 of a tube, with coordinates x along its first wall.
class GnomonicFrame {
 public:
  /// Directions closer to the plane's horizon than this sine have no coordinates.
  static constexpr double shallowest = 1e-3;
  /// The error of a coordinate c is at most margin * (1 + |c|).
  static constexpr double margin = 1e-12;

  GnomonicFrame() = default;
  GnomonicFrame(const std::array<GridPoint, 4>& rays);

  /// Computes the coordinates of a direction of the given length; returns false if it has none.
  bool project(glm::dvec3 d, double length, glm::dvec2& p) const {
    const double depth = glm::dot(d, axis_);
    if (depth < shallowest * length) return false;
    p = {glm::dot(d, right_) / depth, glm::dot(d, up_) / depth};
    return true;
  }
  /// Returns the unit vector to a point.
  ///
  /// Law K4 (direction): project(direction(p)) is p, within margin * (1 + |p|).
  glm::dvec3 direction(glm::dvec2 p) const { return glm::normalize(axis_ + p.x * right_ + p.y * up_); }

  /// Bounds of the tube; infinite if the tube is too wide for a gnomonic plane.
  const Bounds& tube() const { return tube_; }
  /// Returns true if the point is inside the tube by more than the margin.
  bool surely_inside(glm::dvec2 p) const;

 private:
  glm::dvec3 axis_{0, 1, 0}, right_{1, 0, 0}, up_{0, 0, 1};
  std::array<glm::dvec2, 4> corner_{};
  Bounds tube_ = Bounds::everything();
};

/// A facet as seen from an apex, with its distances. These data are the same for all tubes of the apex.
struct RangedFacet {
  FacetCone cone;
  double nearest = 0, farthest = 0;  ///< bounds on its distance from the apex, grid units
  std::array<double, 3> range{};     ///< distances of its vertices

  /// Computes all members except the cone from the cone.
  void measure_ranges();
};

/// A facet that subtends something within a tube.
struct FramedFacet : RangedFacet {
  Bounds bounds = Bounds::everything();
  std::array<glm::dvec2, 3> corner{};  ///< of its vertices; undefined if the bounds are infinite
  double slack = 0;                    ///< bound on the error of a coordinate of a corner
  bool placed = false;                 ///< whether the bounds are finite
  int turn = 0;                        ///< +1 if the corners turn left, -1 right, 0 if that is uncertain
  /// Edge k in the plane: x line.x + y line.y - line.z is positive on the facet's side. Valid if turn is not
  /// 0.
  std::array<glm::dvec3, 3> line{};

  FramedFacet() = default;
  explicit FramedFacet(const RangedFacet& facet) : RangedFacet(facet) {}

  /// Computes all members for the frame's plane from the cone and its ranges.
  void place(const GnomonicFrame& frame);
};

/// Returns whether p is inside (1) or outside (-1) of a finite facet's triangle, or too near to its border to
/// decide (0).
///
/// Law K1 (place): a point that is reported as inside is inside, and one that is reported as outside is
/// outside.
int where(const FramedFacet& facet, glm::dvec2 p);

/// Law K2 (apart): returns true only if the facets' cones have no common interior direction. An edge of one
/// facet then has the other facet on its far side. Shared vertices are on the edge by name; the others must
/// be beyond it by more than rounding.
bool surely_apart(const FramedFacet& a, const FramedFacet& b);

/// Law K3 (cover): returns true only if each direction in the cone of `inner` is in that of `outer` and both
/// have finite bounds.
bool surely_covers(const FramedFacet& outer, const FramedFacet& inner);

}  // namespace tubefoot
