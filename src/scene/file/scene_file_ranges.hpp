// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scene/file/toml_reader.hpp"

// Ranges of values that several keys of a scene file share.
namespace tubefoot {

/// Coordinates and sizes: more than the Earth's radius is a slip, and the world grid ends at 2^30 m.
inline constexpr double far_m = 1e7;
inline constexpr ValueRange coordinate{.lo = -far_m, .hi = far_m};
inline constexpr ValueRange size{.lo = 0, .hi = far_m, .lo_excluded = true};
inline constexpr ValueRange size_or_zero{.lo = 0, .hi = far_m};
inline constexpr ValueRange height{.lo = 0, .hi = 10000};
inline constexpr ValueRange heading{.lo = -360, .hi = 360};
inline constexpr ValueRange pitch{.lo = -90, .hi = 90};
inline constexpr ValueRange roll{.lo = -180, .hi = 180};
inline constexpr ValueRange latitude{.lo = -90, .hi = 90};
inline constexpr ValueRange longitude{.lo = -180, .hi = 180};
inline constexpr ValueRange not_negative{.lo = 0};
inline constexpr ValueRange range_samples{.lo = 1, .hi = 65536};
inline constexpr ValueRange sonar_range{.lo = 0, .hi = 100000, .lo_excluded = true};
inline constexpr ValueRange frequency{.lo = 1, .hi = 10000};
inline constexpr ValueRange index{.lo = 0, .hi = 1000000};
inline constexpr ValueRange count_of_two{.lo = 2, .hi = 1000000};

inline constexpr const char* no_width = "a sector of no width sees nothing";
inline constexpr const char* too_wide =
    "a sector so wide does not project onto a plane, share it among several sensors";
constexpr ValueRange sector(double hi, bool hi_excluded) {
  return {.lo = 0,
          .hi = hi,
          .lo_excluded = true,
          .hi_excluded = hi_excluded,
          .if_below = no_width,
          .if_above = too_wide};
}

/// The place of the later key, or of the earlier one where the later is left to its default.
inline SourcePlace place_of_pair(const TomlTable& table, std::string_view earlier, std::string_view later) {
  return table.place_of(table.has(later) ? later : earlier);
}

}  // namespace tubefoot
