// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <initializer_list>
#include <vector>

#include "scene/file/toml_reader.hpp"

// Ranges of values that keys of several kinds of sensors share, and conditions between two keys.
namespace tubefoot {

inline constexpr ValueRange pitch{.lo = -90, .hi = 90};
inline constexpr ValueRange range_samples{.lo = 1, .hi = 65536};
inline constexpr ValueRange range_start{.lo = 0, .hi = 100000};
inline constexpr ValueRange sonar_range{.lo = 0, .hi = 100000, .lo_excluded = true};
inline constexpr ValueRange frequency{.lo = 1, .hi = 10000};

inline constexpr const char* no_width = "a sector without width receives nothing";
inline constexpr const char* too_wide =
    "a sector of this width cannot be projected onto a plane; distribute it over several sensors";
constexpr ValueRange sector(double hi, bool hi_excluded) {
  return {.lo = 0,
          .hi = hi,
          .lo_excluded = true,
          .hi_excluded = hi_excluded,
          .if_below = no_width,
          .if_above = too_wide};
}

/// Returns the place of the later key, or that of the earlier key if the later has its default.
inline SourcePlace place_of_pair(const TomlTable& table, std::string_view earlier, std::string_view later) {
  return table.place_of(table.has(later) ? later : earlier);
}

/// Checks a sensor's range gate.
inline void check_ranges(double range_min_m, double range_max_m, const TomlTable& table) {
  if (range_min_m >= range_max_m)
    throw InputError(
        place_of_pair(table, "range_min_m", "range_max_m"),
        fmt::format("'range_min_m' ({}) must be less than 'range_max_m' ({})", range_min_m, range_max_m));
}

/// Checks listed beam angles. The keys in `instead` would describe the same beams and are not permitted.
inline void check_beam_angles(const std::vector<double>& angles_deg,
                              std::initializer_list<const char*> instead, const TomlTable& table) {
  if (angles_deg.empty()) return;
  for (const char* key : instead)
    if (table.has(key))
      throw InputError(
          table.place_of(key),
          fmt::format("'beam_angles_deg' already defines the beams: remove '{}' or the list", key));
  for (std::size_t k = 1; k < angles_deg.size(); ++k)
    if (!(angles_deg[k] > angles_deg[k - 1]))
      throw InputError(table.place_of("beam_angles_deg"),
                       fmt::format("'beam_angles_deg' must increase, from port to starboard: {} follows {}",
                                   angles_deg[k], angles_deg[k - 1]));
}

}  // namespace tubefoot
