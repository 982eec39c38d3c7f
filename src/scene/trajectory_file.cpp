// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/trajectory_file.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <string_view>

namespace tubefoot {
namespace {

constexpr std::array<std::string_view, 7> kColumns = {"time_s",      "east_m",    "north_m", "up_m",
                                                      "heading_deg", "pitch_deg", "roll_deg"};

struct Field {
  std::string_view text;
  int column = 1;  // of its first character
};

std::vector<Field> fields_of(std::string_view line) {
  constexpr std::string_view kBlanks = " \t\r";
  std::vector<Field> fields;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    std::size_t first = begin, last = end;
    while (first < last && kBlanks.find(line[first]) != kBlanks.npos) ++first;
    while (first < last && kBlanks.find(line[last - 1]) != kBlanks.npos) --last;
    fields.push_back({line.substr(first, last - first), static_cast<int>(first) + 1});
    begin = end + 1;
  }
  return fields;
}

double number(const Field& field, std::string_view name, SourcePlace place) {
  place.column = field.column;
  double value = 0;
  const char* end = field.text.data() + field.text.size();
  const auto [rest, error] = std::from_chars(field.text.data(), end, value);
  if (error != std::errc() || rest != end || !std::isfinite(value)) {
    throw InputError(place, fmt::format("{} is '{}', expected a finite number", name, field.text));
  }
  return value;
}

class WaypointReader {
 public:
  explicit WaypointReader(const std::filesystem::path& file) : place_{file.string(), 0, 0} {}

  Trajectory read() {
    std::ifstream in(place_.file);
    if (!in) throw InputError(place_, "cannot be opened: check the path and the permissions");
    for (std::string line; std::getline(in, line);) {
      ++place_.line;
      std::string_view text = line;
      if (place_.line == 1 && text.starts_with("\xEF\xBB\xBF"))
        text.remove_prefix(3);  // spreadsheets' UTF-8 mark
      const std::vector<Field> fields = fields_of(text);
      if ((fields.size() == 1 && fields[0].text.empty()) || fields[0].text.starts_with('#')) continue;
      if (header_size_ == 0) {
        read_header(fields);
      } else {
        read_row(fields);
      }
    }
    if (in.bad()) throw InputError(place_, "cannot be read to its end");
    if (header_size_ == 0) {
      throw InputError({place_.file, 0, 0},
                       fmt::format("is empty, expected the header line {}", fmt::join(kColumns, ",")));
    }
    if (samples_.empty()) {
      throw InputError({place_.file, 0, 0}, "has a header but no waypoint, expected at least one row");
    }
    return Trajectory(std::move(samples_));
  }

 private:
  void read_header(const std::vector<Field>& fields) {
    header_size_ = fields.size();
    for (std::size_t wanted = 0; wanted < kColumns.size(); ++wanted) {
      std::size_t found = 0;
      while (found < fields.size() && fields[found].text != kColumns[wanted]) ++found;
      if (found == fields.size()) {
        throw InputError(place_, fmt::format("the column {} is missing, expected the header {}",
                                             kColumns[wanted], fmt::join(kColumns, ",")));
      }
      column_[wanted] = found;
    }
  }

  void read_row(const std::vector<Field>& fields) {
    if (fields.size() != header_size_) {
      throw InputError(place_, fmt::format("the row has {} fields, expected {} as in the header",
                                           fields.size(), header_size_));
    }
    std::array<double, 7> v{};
    for (std::size_t i = 0; i < v.size(); ++i) v[i] = number(fields[column_[i]], kColumns[i], place_);
    if (!samples_.empty() && !(v[0] > samples_.back().time_s)) {
      SourcePlace place = place_;
      place.column = fields[column_[0]].column;
      throw InputError(place, fmt::format("time_s is {} after {}, expected times that increase", v[0],
                                          samples_.back().time_s));
    }
    samples_.push_back({v[0],
                        {{v[1], v[2], v[3]},
                         attitude_from_angles(glm::radians(v[4]), glm::radians(v[5]), glm::radians(v[6]))}});
  }

  SourcePlace place_;
  std::size_t header_size_ = 0;
  std::array<std::size_t, 7> column_{};  // field of each of kColumns
  std::vector<Trajectory::Sample> samples_;
};

glm::dvec3 vec(const std::array<double, 3>& a) { return {a[0], a[1], a[2]}; }

struct Maker {
  const SourcePlace& place;

  Trajectory operator()(const FixedTrajectory& fixed) const {
    const glm::dquat attitude = attitude_from_angles(
        glm::radians(fixed.heading_deg), glm::radians(fixed.pitch_deg), glm::radians(fixed.roll_deg));
    return Trajectory({{0.0, {vec(fixed.position_m), attitude}}});
  }

  Trajectory operator()(const LineTrajectory& line) const {
    const glm::dvec3 start = vec(line.start_m), end = vec(line.end_m), way = end - start;
    if (!(line.speed_m_s > 0) || !std::isfinite(line.speed_m_s)) {
      throw InputError(place,
                       fmt::format("the line's speed is {} m/s, expected more than 0", line.speed_m_s));
    }
    if (way.x == 0 && way.y == 0) {
      throw InputError(
          place,
          "the line's start and end lie above each other, so it has no heading: move one of them, or give "
          "the poses as a waypoint file");
    }
    const glm::dquat attitude = attitude_from_angles(std::atan2(way.x, way.y), glm::radians(line.pitch_deg),
                                                     glm::radians(line.roll_deg));
    return Trajectory({{0.0, {start, attitude}}, {glm::length(way) / line.speed_m_s, {end, attitude}}});
  }

  Trajectory operator()(const WaypointTrajectory& waypoints) const {
    try {
      return read_waypoints(waypoints.file);
    } catch (const InputError& error) {
      throw InputError(place, error.what());
    }
  }
};

}  // namespace

Trajectory read_waypoints(const std::filesystem::path& file) { return WaypointReader(file).read(); }

Trajectory make_trajectory(const TrajectoryDescription& description) {
  return std::visit(Maker{description.place}, description.kind);
}

}  // namespace tubefoot
