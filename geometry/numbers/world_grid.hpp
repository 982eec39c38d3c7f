// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <stdexcept>
#include <string>

namespace tubefoot {

/// A point or vector of the world grid, in grid units. All exact geometry starts from these integers.
struct GridPoint {
  std::int32_t x = 0, y = 0, z = 0;
  friend auto operator<=>(const GridPoint&, const GridPoint&) = default;
};

struct GridPointHash {
  std::size_t operator()(const GridPoint& p) const noexcept;
};

/// Thrown if a coordinate exceeds the grid or the bit budget (docs/notes/bit-budget.md).
struct GridRangeError : std::range_error {
  using std::range_error::range_error;
};

/// The dyadic grid to which every vertex and apex is snapped once, when it is loaded. The unit is 2^-k m in
/// the local east-north-up frame. The origin is a multiple of the unit.
class WorldGrid {
 public:
  /// Bits of an apex-relative coordinate: |x| <= 2^30. The exact arithmetic is derived from this number.
  static constexpr int coordinate_bits = 30;
  /// Default and finest unit that `fitting` chooses: 2^-20 m, about 1 micrometre.
  static constexpr int finest_exponent = 20;

  /// Constructs a grid of unit 2^-`exponent` m; `origin_m` is rounded to a multiple of the unit.
  WorldGrid(int exponent, glm::dvec3 origin_m);

  /// Returns the grid of the finest unit for which every difference of two points in the box [lo, hi]
  /// (metres) fits the coordinate bits. The unit is not finer than 2^-finest_exponent m. The origin is the
  /// box's centre. Throws GridRangeError if the box is not finite or so large (> 2^30 m) that no unit of 1 m
  /// or less fits.
  ///
  /// Law W1 (fitting): every difference of two points of the box fits, and would not fit with half the unit.
  static WorldGrid fitting(glm::dvec3 lo_m, glm::dvec3 hi_m);

  /// Returns the grid of the given unit. Throws GridRangeError if the box does not fit; the message names the
  /// unit that would fit.
  static WorldGrid with_exponent(int exponent, glm::dvec3 lo_m, glm::dvec3 hi_m);

  int exponent() const { return exponent_; }
  double unit_m() const;
  glm::dvec3 origin_m() const { return origin_m_; }

  /// Returns the nearest grid point (ties away from zero). Throws GridRangeError if the point is not finite
  /// or exceeds 31 bits.
  ///
  /// Law W2 (snapping): a point moves by at most half a unit in each coordinate, and a grid point does not
  /// move.
  GridPoint snap(glm::dvec3 point_m) const;
  /// Returns a grid point in metres of the local frame. Exact.
  glm::dvec3 to_metres(GridPoint p) const;

 private:
  int exponent_;
  glm::dvec3 origin_m_;
};

}  // namespace tubefoot
