// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/model/pattern_file.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <string_view>

#include "files/csv_file.hpp"
#include "files/input_registry.hpp"
#include "sensors/model/angles.hpp"

namespace tubefoot {
namespace {

constexpr std::string_view header = "angle_deg,level_db";

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view blanks = " \t\r";
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == text.npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

double number(std::string_view text, const char* name, const SourcePlace& place) {
  double value = 0;
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || rest != end || !std::isfinite(value))
    throw InputError(place, fmt::format("{} is '{}': expected a finite number", name, text));
  return value;
}

}  // namespace

PatternTable read_pattern_file(const std::filesystem::path& file) {
  constexpr std::size_t most_rows = 1000000;
  SourcePlace place{file.string(), 0, 0};
  InputFile input(file);
  std::istream& in = input.stream();
  bool headed = false;
  std::vector<double> angle_deg, level_db;
  for (std::string line; ++place.line, next_line(in, line, place);) {
    std::string_view text = line;
    if (place.line == 1 && text.starts_with("\xEF\xBB\xBF"))
      text.remove_prefix(3);  // byte-order mark of spreadsheets
    text = trimmed(text);
    if (text.empty() || text.front() == '#') continue;
    const std::size_t comma = text.find(',');
    if (comma == text.npos || text.find(',', comma + 1) != text.npos)
      throw InputError(place, fmt::format("expected two fields: {}", header));
    const std::string_view first = trimmed(text.substr(0, comma)), second = trimmed(text.substr(comma + 1));
    if (!headed) {
      if (first != header.substr(0, 9) || second != header.substr(10))
        throw InputError(place, fmt::format("expected the header line {}", header));
      headed = true;
      continue;
    }
    const double angle = number(first, "angle_deg", place), level = number(second, "level_db", place);
    if (std::abs(angle) > 180)
      throw InputError(place, fmt::format("angle_deg is {}: expected -180 to 180", angle));
    if (std::abs(level) > 1000)
      throw InputError(place, fmt::format("level_db is {}: expected -1000 to 1000", level));
    // At smaller steps angles in radians may be equal, and a slope between them would not be a number.
    constexpr double least_step_deg = 1e-9;
    if (!angle_deg.empty() && !(angle - angle_deg.back() >= least_step_deg))
      throw InputError(
          place, fmt::format("angle_deg is {}, but the previous angle is {}: expected increasing angles",
                             angle, angle_deg.back()));
    if (angle_deg.size() == most_rows)
      throw InputError(
          place,
          fmt::format("the file has more than {} rows, which is the limit for a beam pattern", most_rows));
    angle_deg.push_back(angle);
    level_db.push_back(level);
  }
  if (in.bad()) throw InputError(place, "cannot be read completely");
  const SourcePlace whole{file.string(), 0, 0};
  if (!headed) throw InputError(whole, fmt::format("is empty: expected the header line {}", header));
  if (angle_deg.size() < 2)
    throw InputError(whole, fmt::format("has {} rows: expected at least two angles", angle_deg.size()));

  std::vector<double> angle_rad, level;
  if (angle_deg.front() == 0)
    for (std::size_t k = angle_deg.size() - 1; k > 0; --k) {
      angle_rad.push_back(-radians(angle_deg[k]));
      level.push_back(level_db[k]);
    }
  for (std::size_t k = 0; k < angle_deg.size(); ++k) {
    angle_rad.push_back(radians(angle_deg[k]));
    level.push_back(level_db[k]);
  }
  return PatternTable(std::move(angle_rad), level);
}

}  // namespace tubefoot
