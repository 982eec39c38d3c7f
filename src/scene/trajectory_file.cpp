// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/trajectory_file.hpp"

#include <fmt/core.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <string_view>

#include "files/csv_file.hpp"
#include "scene/file/scene_file_ranges.hpp"

namespace tubefoot {
namespace {

constexpr std::array<std::string_view, 7> kColumns = {"time_s",      "east_m",    "north_m", "up_m",
                                                      "heading_deg", "pitch_deg", "roll_deg"};

// Years that have times to the microsecond in a double; the coordinates of scene files; any number of turns.
constexpr std::array<double, 7> kLargest = {1e10, far_m, far_m, far_m, 1e6, 1e6, 1e6};

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

Trajectory read_waypoints(const std::filesystem::path& file) {
  std::vector<Trajectory::Sample> samples;
  read_csv(file, kColumns, [&](const CsvRow& row) {
    const auto& v = row.values;
    for (std::size_t k = 0; k < kColumns.size(); ++k)
      if (!(std::abs(v[k]) <= kLargest[k]))
        throw InputError(row.places[k], fmt::format("{} is {}, expected {:g} to {:g}", kColumns[k], v[k],
                                                    -kLargest[k], kLargest[k]));
    if (!samples.empty() && !(v[0] > samples.back().time_s)) {
      throw InputError(row.places[0], fmt::format("time_s is {} after {}, expected times that increase", v[0],
                                                  samples.back().time_s));
    }
    samples.push_back({v[0],
                       {{v[1], v[2], v[3]},
                        attitude_from_angles(glm::radians(v[4]), glm::radians(v[5]), glm::radians(v[6]))}});
  });
  if (samples.empty()) {
    throw InputError({file.string(), 0, 0}, "has a header but no waypoint, expected at least one row");
  }
  return Trajectory(std::move(samples));
}

Trajectory make_trajectory(const TrajectoryDescription& description) {
  return std::visit(Maker{description.place}, description.kind);
}

}  // namespace tubefoot
