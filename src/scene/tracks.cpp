// SPDX-License-Identifier: GPL-3.0-or-later

// Creates trajectories from their descriptions: a fixed pose, a straight line, a file of waypoints, or
// parallel survey lines with turns between them.

#include "scene/tracks.hpp"

#include <fmt/core.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <stdexcept>

#include "files/limits.hpp"
#include "scene/waypoint_file.hpp"

namespace tubefoot {
namespace {

glm::dvec3 vec(const std::array<double, 3>& a) { return {a[0], a[1], a[2]}; }

struct Maker {
  const SourcePlace& place;
  const TrackSurroundings& around;

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
      throw InputError(place,
                       "the line's start and end lie above each other, so the line has no heading: move one "
                       "of them, or give the poses as a waypoint file");
    }
    const glm::dquat attitude = attitude_from_angles(std::atan2(way.x, way.y), glm::radians(line.pitch_deg),
                                                     glm::radians(line.roll_deg));
    return Trajectory({{0.0, {start, attitude}}, {glm::length(way) / line.speed_m_s, {end, attitude}}});
  }

  Trajectory operator()(const WaypointTrajectory& waypoints) const {
    try {
      return read_waypoints(waypoints, around);
    } catch (const InputError& error) {
      throw InputError(place, error.what());
    }
  }

  Trajectory operator()(const SurveyTrajectory& survey) const {
    const std::size_t lines = count_of_lines(survey);
    const double heading = glm::radians(survey.heading_deg);
    const glm::dvec2 along(std::sin(heading), std::cos(heading)), starboard(along.y, -along.x);
    const std::size_t steps = steps_of(survey, lines);
    const glm::dvec2 centre = centre_of(survey);
    std::vector<glm::dvec2> places;
    for (std::size_t line = 0; line < lines; ++line) {
      const double off_m =
          (static_cast<double>(line) - static_cast<double>(lines - 1) / 2) * survey.spacing_m;
      const double way = sense(survey, line);
      for (std::size_t k = 0; k <= steps; ++k)
        places.push_back(centre + off_m * starboard +
                         way * (static_cast<double>(k) / static_cast<double>(steps) - 0.5) * survey.length_m *
                             along);
    }
    const std::vector<double> heights = heights_of(survey, places, steps + 1);
    SurveyLines track(survey.turn_s);
    for (std::size_t line = 0; line < lines; ++line) {
      const glm::dvec2 course = sense(survey, line) * along;
      const glm::dquat attitude = attitude_from_angles(
          std::atan2(course.x, course.y), glm::radians(survey.pitch_deg), glm::radians(survey.roll_deg));
      std::vector<Trajectory::Sample> samples;
      for (std::size_t k = 0; k <= steps; ++k) {
        const std::size_t p = line * (steps + 1) + k;
        samples.push_back(
            {static_cast<double>(k) / static_cast<double>(steps) * survey.length_m / survey.speed_m_s,
             {glm::dvec3(places[p], heights[p]), attitude}});
      }
      track.add(std::move(samples));
    }
    return std::move(track).finish();
  }

 private:
  /// Returns +1 along the heading of the first line, -1 against it.
  static double sense(const SurveyTrajectory& survey, std::size_t line) {
    return survey.one_way || line % 2 == 0 ? 1 : -1;
  }

  std::size_t count_of_lines(const SurveyTrajectory& survey) const {
    constexpr double most = 10000, rounding = 1e-9;
    const double count = std::floor(survey.width_m / survey.spacing_m + rounding) + 1;
    if (!(count <= most))
      throw InputError(place, fmt::format("a spacing of {} m over a width of {} m gives {:.4g} lines, "
                                          "expected at most {}: increase 'spacing_m'",
                                          survey.spacing_m, survey.width_m, count, most));
    return static_cast<std::size_t>(count);
  }

  /// Returns the number of sections of a line. The height is linear within a section.
  std::size_t steps_of(const SurveyTrajectory& survey, std::size_t lines) const {
    if (!survey.altitude_m) return 1;
    const double steps = std::ceil(survey.length_m / survey.altitude_step_m.value_or(*survey.altitude_m));
    if (!(steps * static_cast<double>(lines) <= limits::table_rows))
      throw InputError(
          place,
          fmt::format(
              "the survey's lines would need {:.4g} heights, expected at most {}: increase 'altitude_step_m'",
              steps * static_cast<double>(lines), limits::table_rows));
    return static_cast<std::size_t>(std::max(steps, 1.0));
  }

  glm::dvec2 centre_of(const SurveyTrajectory& survey) const {
    if (const auto& centre = survey.centre_lat_lon_deg) {
      glm::dvec3 point((*centre)[1], (*centre)[0], 0);
      around.place_by_lon_lat({&point, 1}, place);
      return point;
    }
    if (const auto& centre = survey.centre_crs) {
      glm::dvec3 point((*centre)[0], (*centre)[1], 0);
      around.place_by_crs({&point, 1}, place);
      return point;
    }
    return {survey.centre_m[0], survey.centre_m[1]};
  }

  std::vector<double> heights_of(const SurveyTrajectory& survey, std::span<const glm::dvec2> places,
                                 std::size_t places_a_line) const {
    if (!survey.altitude_m)
      return std::vector<double>(places.size(),
                                 survey.up_m.value_or(around.surface_height_m - survey.depth_m.value_or(0)));
    std::vector<double> heights;
    const auto surface_mesh = around.terrain_heights_m(places);
    for (std::size_t p = 0; p < places.size(); ++p) {
      if (!surface_mesh[p])
        throw InputError(
            place, fmt::format("'altitude_m': there is no terrain below line {} at {:.3f} m east, {:.3f} "
                               "m north: move or shorten the survey, or give its height as 'up_m' or "
                               "'depth_m'",
                               p / places_a_line + 1, places[p].x, places[p].y));
      heights.push_back(*surface_mesh[p] + *survey.altitude_m);
    }
    return heights;
  }
};

}  // namespace

Trajectory make_trajectory(const TrajectoryDescription& description, const TrackSurroundings& around) {
  try {
    return std::visit(Maker{description.place, around}, description.kind);
  } catch (const std::invalid_argument& error) {
    throw InputError(description.place, error.what());
  }
}

}  // namespace tubefoot
