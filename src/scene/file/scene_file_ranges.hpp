// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scene/file/sensor_ranges.hpp"

// Ranges of values that several keys of a scene file share.
namespace tubefoot {

/// Coordinates and sizes. A value above the Earth's radius is probably an error, and the world grid ends at
/// 2^30 m.
inline constexpr double far_m = 1e7;
inline constexpr ValueRange coordinate{.lo = -far_m, .hi = far_m};
inline constexpr ValueRange size{.lo = 0, .hi = far_m, .lo_excluded = true};
inline constexpr ValueRange size_or_zero{.lo = 0, .hi = far_m};
inline constexpr ValueRange height{.lo = 0, .hi = 10000};
inline constexpr ValueRange heading{.lo = -360, .hi = 360};
inline constexpr ValueRange roll{.lo = -180, .hi = 180};
inline constexpr ValueRange latitude{.lo = -90, .hi = 90};
inline constexpr ValueRange longitude{.lo = -180, .hi = 180};
inline constexpr ValueRange not_negative{.lo = 0};
inline constexpr ValueRange index{.lo = 0, .hi = 1000000};
inline constexpr ValueRange count_of_two{.lo = 2, .hi = 1000000};
/// Largest k of the world grid's unit 2^-k m.
inline constexpr int finest_grid_exponent = 30;

}  // namespace tubefoot
