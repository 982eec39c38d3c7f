// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/numbers/world_grid.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

// Converts coordinates in metres to integers of the world grid and back. The unit is a power of two, so
// scaling is exact and each coordinate is rounded only once.

namespace tubefoot {
namespace {

// Finer units leave too few bits for the magnitude of a projected coordinate (7e6 m is 2^23).
constexpr int kLargestExponent = 36;
constexpr std::int64_t kReach = std::int64_t{1} << WorldGrid::coordinate_bits;

bool is_finite(glm::dvec3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

std::string text(glm::dvec3 v) { return fmt::format("({:.10g}, {:.10g}, {:.10g}) m", v.x, v.y, v.z); }

// Converts metres to whole units. The code rounds the absolute coordinate (scaling by 2^k is exact) and
// subtracts integers afterwards, which is exact. Subtracting first would round twice.
std::int64_t whole_units(double metres, int exponent) {
  const double units = std::ldexp(metres, exponent);
  if (!(std::abs(units) < 0x1p62)) {
    throw GridRangeError(
        fmt::format("coordinate {} m is too large for a grid of unit 2^-{} m", metres, exponent));
  }
  return std::llround(units);
}

double longest_side(glm::dvec3 lo, glm::dvec3 hi) {
  if (!is_finite(lo) || !is_finite(hi)) {
    throw GridRangeError(fmt::format("extent {} to {} is not finite", text(lo), text(hi)));
  }
  return std::max({hi.x - lo.x, hi.y - lo.y, hi.z - lo.z});
}

// Both ends of the box and the origin are rounded, which may lengthen a side by two units.
bool fits(double side_m, int exponent) {
  return std::ldexp(side_m, exponent) <= static_cast<double>(kReach - 2);
}

// Returns the finest exponent that fits, or -1.
int finest_fitting(double side_m) {
  int exponent = WorldGrid::finest_exponent;
  while (exponent >= 0 && !fits(side_m, exponent)) --exponent;
  return exponent;
}

}  // namespace

std::size_t GridPointHash::operator()(const GridPoint& p) const noexcept {
  // Multiply-xorshift rounds with the constants of SplitMix64 (Steele, Lea and Flood). Neighbours on a
  // regular grid differ in few bits, and a plain sum would cause many collisions.
  const auto mix = [](std::uint64_t h) {
    h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9u;
    h = (h ^ (h >> 27)) * 0x94d049bb133111ebu;
    return h ^ (h >> 31);
  };
  const auto xy = (std::uint64_t{static_cast<std::uint32_t>(p.x)} << 32) | static_cast<std::uint32_t>(p.y);
  return mix(mix(xy) ^ static_cast<std::uint32_t>(p.z));
}

WorldGrid::WorldGrid(int exponent, glm::dvec3 origin_m) : exponent_(exponent), origin_m_(0) {
  if (exponent < 0 || exponent > kLargestExponent) {
    throw GridRangeError(
        fmt::format("invalid grid exponent {}: expected 0 (unit 1 m) to {}", exponent, kLargestExponent));
  }
  for (int axis = 0; axis < 3; ++axis) {
    origin_m_[axis] = std::ldexp(static_cast<double>(whole_units(origin_m[axis], exponent)), -exponent);
  }
}

WorldGrid WorldGrid::fitting(glm::dvec3 lo_m, glm::dvec3 hi_m) {
  const double side = longest_side(lo_m, hi_m);
  const int exponent = finest_fitting(side);
  if (exponent < 0) {
    throw GridRangeError(
        fmt::format("extent {} to {} is too large: its longest side is {:.6g} m, and at most {:.6g} m fit a "
                    "grid of unit 1 m",
                    text(lo_m), text(hi_m), side, static_cast<double>(kReach - 2)));
  }
  return WorldGrid(exponent, 0.5 * lo_m + 0.5 * hi_m);
}

WorldGrid WorldGrid::with_exponent(int exponent, glm::dvec3 lo_m, glm::dvec3 hi_m) {
  const double side = longest_side(lo_m, hi_m);
  if (!fits(side, exponent)) {
    const int finest = finest_fitting(side);
    throw GridRangeError(fmt::format("extent {} to {} does not fit a grid of unit 2^-{} m; {}", text(lo_m),
                                     text(hi_m), exponent,
                                     finest < 0 ? std::string("no unit of 1 m or less would fit")
                                                : fmt::format("2^-{} m would fit", finest)));
  }
  return WorldGrid(exponent, 0.5 * lo_m + 0.5 * hi_m);
}

double WorldGrid::unit_m() const { return std::ldexp(1.0, -exponent_); }

GridPoint WorldGrid::snap(glm::dvec3 point_m) const {
  if (!is_finite(point_m)) throw GridRangeError(fmt::format("point {} is not finite", text(point_m)));
  std::int64_t units[3];
  for (int axis = 0; axis < 3; ++axis) {
    units[axis] = whole_units(point_m[axis], exponent_) - whole_units(origin_m_[axis], exponent_);
    if (units[axis] < -kReach || units[axis] > kReach) {
      throw GridRangeError(
          fmt::format("point {} is outside of the grid, which extends {:.6g} m around {} at unit 2^-{} m",
                      text(point_m), static_cast<double>(kReach) * unit_m(), text(origin_m_), exponent_));
    }
  }
  return {static_cast<std::int32_t>(units[0]), static_cast<std::int32_t>(units[1]),
          static_cast<std::int32_t>(units[2])};
}

glm::dvec3 WorldGrid::to_metres(GridPoint p) const {
  return origin_m_ + glm::dvec3(p.x, p.y, p.z) * unit_m();
}

}  // namespace tubefoot
