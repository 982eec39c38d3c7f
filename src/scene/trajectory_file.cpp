// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/trajectory_file.hpp"

#include <fmt/core.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <numbers>
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

std::vector<std::string> odd_waypoints(const std::vector<Trajectory::Sample>& samples,
                                       const std::filesystem::path& file) {
  std::vector<std::string> odd;
  const auto apart = [](double a, double b) { return std::abs(std::remainder(a - b, 2 * std::numbers::pi)); };
  std::size_t moves = 0, in_radians = 0;
  double way_m = 0;
  for (std::size_t k = 1; k < samples.size(); ++k) {
    const glm::dvec3 step = samples[k].pose.position_m - samples[k - 1].pose.position_m;
    way_m += glm::length(step);
    if (std::hypot(step.x, step.y) < 1e-3) continue;
    ++moves;
    const glm::dvec3 ahead = samples[k].pose.attitude * glm::dvec3(0, 1, 0);
    const double course = std::atan2(step.x, step.y), heading = std::atan2(ahead.x, ahead.y),
                 as_radians = glm::degrees(heading);
    constexpr double near = 0.2, far = 0.35;
    if (std::abs(as_radians) < 6.3 && apart(as_radians, course) < near && apart(heading, course) > far)
      ++in_radians;
  }
  if (moves > 0 && 10 * in_radians >= 9 * moves)
    odd.push_back(fmt::format(
        "{}: heading_deg looks like radians: taken for degrees the headings do not fit the way from waypoint "
        "to waypoint, taken for radians they do",
        file.string()));
  const double lasts_s = samples.back().time_s - samples.front().time_s, speed_m_s = way_m / lasts_s;
  constexpr double fast_m_s = 30, slow_m_s = 0.005;
  if (lasts_s > 0 && (speed_m_s > fast_m_s || (speed_m_s < slow_m_s && way_m > 1)))
    odd.push_back(fmt::format("{}: {:.4g} m in {:.4g} s are {:.3g} m/s: does time_s count seconds?",
                              file.string(), way_m, lasts_s, speed_m_s));
  return odd;
}

std::vector<Trajectory::Sample> samples_of(const std::filesystem::path& file) {
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
  return samples;
}

struct Maker {
  const SourcePlace& place;
  std::vector<std::string>* odd;

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
      std::vector<Trajectory::Sample> samples = samples_of(waypoints.file);
      if (odd != nullptr)
        for (std::string& words : odd_waypoints(samples, waypoints.file)) odd->push_back(std::move(words));
      return Trajectory(std::move(samples));
    } catch (const InputError& error) {
      throw InputError(place, error.what());
    }
  }
};

}  // namespace

Trajectory read_waypoints(const std::filesystem::path& file) { return Trajectory(samples_of(file)); }

Trajectory make_trajectory(const TrajectoryDescription& description, std::vector<std::string>* odd) {
  return std::visit(Maker{description.place, odd}, description.kind);
}

}  // namespace tubefoot
