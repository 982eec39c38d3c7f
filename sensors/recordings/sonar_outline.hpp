// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <string>
#include <utility>
#include <vector>

namespace tubefoot {

/// Form of a sonar for external engines, which distinguish fans, two-sided sonars and turning beams. It
/// includes the sonar's scene keys, so that the conversion back is exact.
struct SonarOutline {
  enum class Shape { fan, two_sides, turning };
  Shape shape = Shape::fan;
  std::string kind;                   ///< name in scene files; empty: the kind's own name
  bool looks_down = false;            ///< the fan's middle is down, not ahead
  bool even = true;                   ///< equiangular
  bool narrowly_lit = false;          ///< the received sector is larger than the transmit sector
  double vertical_deg = 0;            ///< across the fan; two sides: of each, across the track
  double depression_deg = 0;          ///< two sides: of the middle of each
  double along_track_deg = 0;         ///< two sides
  double scan_deg = 0, step_deg = 0;  ///< turning
  std::vector<std::pair<std::string, std::string>> keys;  ///< name, and value without quotes

  template <class Value>
  SonarOutline& add(const char* name, const Value& value) {
    keys.emplace_back(name, fmt::format("{}", value));
    return *this;
  }
  SonarOutline& add(const char* name, const std::vector<double>& values) {
    keys.emplace_back(name, fmt::format("{}", fmt::join(values, " ")));
    return *this;
  }
  /// Adds the keys of a range gate.
  template <class Own>
  SonarOutline& add_window(const Own& own) {
    return add("samples", own.samples)
        .add("range_min_m", own.range_min_m)
        .add("range_max_m", own.range_max_m);
  }
};

}  // namespace tubefoot
