// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <string>
#include <utility>
#include <vector>

namespace tubefoot {

/// A sonar's form as engines know it that have fans, two sides and turning beams, and its keys as a scene
/// file has them, so that a way back is exact.
struct SonarOutline {
  enum class Shape { fan, two_sides, turning };
  Shape shape = Shape::fan;
  std::string kind;                   ///< as a scene file has it; empty: the kind's own name
  bool looks_down = false;            ///< its fan lies about "down", not about "ahead"
  bool even = true;                   ///< equal steps of angle
  bool narrowly_lit = false;          ///< it receives more than it sends to
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
  /// The keys of a range window.
  template <class Own>
  SonarOutline& add_window(const Own& own) {
    return add("samples", own.samples)
        .add("range_min_m", own.range_min_m)
        .add("range_max_m", own.range_max_m);
  }
};

}  // namespace tubefoot
