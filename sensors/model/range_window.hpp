// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "engine/echo/echo.hpp"
#include "sensors/model/angles.hpp"

// Common parts of kinds with the keys samples, range_min_m and range_max_m.
namespace tubefoot {

/// Throws std::invalid_argument for an invalid range gate or count.
template <class Keys>
RangeSamples range_window(const SensorDescription& description, const Keys& keys) {
  require(keys.samples >= 1, description, "samples", keys.samples, "1 or more");
  require(keys.range_min_m >= 0, description, "range_min_m", keys.range_min_m, "0 or more");
  require(keys.range_max_m > keys.range_min_m, description, "range_max_m", keys.range_max_m,
          "above range_min_m");
  return {keys.range_min_m, (keys.range_max_m - keys.range_min_m) / keys.samples, keys.samples};
}

template <class Keys>
SensorFigures range_figures(const Keys& keys, std::int64_t beams, double beam_deg) {
  constexpr std::int64_t transmissions = 1;
  return {keys.frequency_khz,
          beams,
          keys.samples,
          transmissions,
          (keys.range_max_m - keys.range_min_m) / keys.samples,
          beam_deg,
          keys.range_max_m};
}

}  // namespace tubefoot
