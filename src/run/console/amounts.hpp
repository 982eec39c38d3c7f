// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <fmt/format.h>

#include <string>

// This header formats durations and file sizes in readable units.
namespace tubefoot {

inline std::string duration_text(double seconds) {
  constexpr double minute = 60, hour = 3600;
  if (seconds < 2 * minute) return fmt::format("{:.3g} s", seconds);
  if (seconds < 2 * hour) return fmt::format("{:.3g} minutes", seconds / minute);
  return fmt::format("{:.3g} hours", seconds / hour);
}

inline std::string size_text(double bytes) {
  if (bytes < 1e6) return fmt::format("{:.3g} kB", bytes / 1e3);
  if (bytes < 1e9) return fmt::format("{:.3g} MB", bytes / 1e6);
  return fmt::format("{:.4g} GB", bytes / 1e9);
}

}  // namespace tubefoot
