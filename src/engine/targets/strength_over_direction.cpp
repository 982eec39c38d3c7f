// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/targets/strength_over_direction.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace tubefoot {
namespace {

constexpr double full_turn_deg = 360;

/// Position on an axis: the value lies between entry `below` and entry `above`, at `share` of the way.
struct AxisPlace {
  std::size_t below = 0, above = 0;
  double share = 0;
};

/// Returns the position of a value, which counts as the nearest entry outside of the axis.
AxisPlace place_on(const std::vector<double>& axis, double value) {
  if (!(value > axis.front())) return {};
  if (!(value < axis.back())) return {axis.size() - 1, axis.size() - 1, 0};
  const auto above = static_cast<std::size_t>(std::ranges::upper_bound(axis, value) - axis.begin());
  return {above - 1, above, (value - axis[above - 1]) / (axis[above] - axis[above - 1])};
}

/// Returns the position of an azimuth, which continues from the last entry to the first one of the next turn.
AxisPlace place_on_circle(const std::vector<double>& axis, double azimuth_deg) {
  if (axis.size() == 1) return {};
  double turned = std::fmod(azimuth_deg - axis.front(), full_turn_deg);
  if (turned < 0) turned += full_turn_deg;
  const double value = axis.front() + turned;
  if (value < axis.back()) return place_on(axis, value);
  const double gap = axis.front() + full_turn_deg - axis.back();
  if (!(gap > 0)) return {axis.size() - 1, axis.size() - 1, 0};
  return {axis.size() - 1, 0, std::clamp((value - axis.back()) / gap, 0.0, 1.0)};
}

void require_increasing(const std::vector<double>& axis, const char* what) {
  if (axis.empty()) throw std::invalid_argument(fmt::format("the table has no {}", what));
  for (std::size_t k = 1; k < axis.size(); ++k)
    if (!(axis[k] > axis[k - 1]))
      throw std::invalid_argument(
          fmt::format("the {} do not increase: {} follows {}", what, axis[k], axis[k - 1]));
}

}  // namespace

StrengthOverDirection::StrengthOverDirection(std::vector<double> elevations_deg,
                                             std::vector<double> azimuths_deg,
                                             std::vector<double> frequencies_hz,
                                             std::vector<double> cross_sections_m2)
    : elevations_deg_(std::move(elevations_deg)),
      azimuths_deg_(std::move(azimuths_deg)),
      frequencies_hz_(std::move(frequencies_hz)),
      cross_sections_m2_(std::move(cross_sections_m2)) {
  require_increasing(elevations_deg_, "elevations");
  require_increasing(azimuths_deg_, "azimuths");
  require_increasing(frequencies_hz_, "frequencies");
  const std::size_t values = elevations_deg_.size() * azimuths_deg_.size() * frequencies_hz_.size();
  if (cross_sections_m2_.size() != values)
    throw std::invalid_argument(
        fmt::format("the table has {} values, expected {}", cross_sections_m2_.size(), values));
  double largest = 0;
  for (const double value : cross_sections_m2_) {
    if (!(value >= 0 && std::isfinite(value)))
      throw std::invalid_argument(
          fmt::format("the cross-section {} m2 is not a finite number of 0 or more", value));
    largest = std::max(largest, value);
  }
  double step = full_turn_deg, largest_step = 0;
  for (std::size_t k = 1; k < azimuths_deg_.size(); ++k) {
    step = std::min(step, azimuths_deg_[k] - azimuths_deg_[k - 1]);
    largest_step = std::max(largest_step, azimuths_deg_[k] - azimuths_deg_[k - 1]);
  }
  if (azimuths_deg_.size() > 1) {
    const double span = azimuths_deg_.back() - azimuths_deg_.front(), gap = full_turn_deg - span;
    constexpr double rounding = 1e-9;
    if (gap < -rounding || gap > 2 * largest_step)
      throw std::invalid_argument(
          fmt::format("the azimuths extend over {} degrees: expected a full turn, or a single azimuth for a "
                      "body of revolution about its z axis",
                      span));
    if (gap > rounding) step = std::min(step, gap);
  }
  for (std::size_t k = 1; k < elevations_deg_.size(); ++k)
    step = std::min(step, elevations_deg_[k] - elevations_deg_[k - 1]);
  // The angles of a direction have an error of less than 1e-13 degrees. Next to the axis of the azimuths it
  // is larger, but there the direction itself is undefined.
  rounding_m2_ = largest * (1e-14 + 1e-12 / step);
}

double StrengthOverDirection::at(glm::dvec3 direction, double frequency_hz) const {
  const double degrees = 180 / std::numbers::pi, azimuth_deg = std::atan2(direction.y, direction.x) * degrees,
               elevation_deg = std::atan2(direction.z, std::hypot(direction.x, direction.y)) * degrees;
  const AxisPlace e = place_on(elevations_deg_, elevation_deg),
                  a = place_on_circle(azimuths_deg_, azimuth_deg),
                  f = place_on(frequencies_hz_, frequency_hz);
  const auto value = [&](std::size_t elevation, std::size_t azimuth) {
    const double* row =
        &cross_sections_m2_[(elevation * azimuths_deg_.size() + azimuth) * frequencies_hz_.size()];
    return row[f.below] + f.share * (row[f.above] - row[f.below]);
  };
  const auto at_elevation = [&](std::size_t elevation) {
    const double below = value(elevation, a.below);
    return a.share == 0 ? below : below + a.share * (value(elevation, a.above) - below);
  };
  const double below = at_elevation(e.below);
  return e.share == 0 ? below : below + e.share * (at_elevation(e.above) - below);
}

bool StrengthOverDirection::covers(double frequency_hz) const {
  constexpr double beyond = 0.01;
  return frequency_hz >= frequencies_hz_.front() * (1 - beyond) &&
         frequency_hz <= frequencies_hz_.back() * (1 + beyond);
}

}  // namespace tubefoot
