// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>

#include "files/input_error.hpp"

// What a scene file says: scene/description/scene_description.hpp.
namespace tubefoot {

/// Pose of the carrier: position in the local frame, heading clockwise from north, pitch bow up,
/// roll starboard down.
struct FixedTrajectory {
  std::array<double, 3> position_m{0, 0, 0};
  double heading_deg = 0, pitch_deg = 0, roll_deg = 0;
};
struct LineTrajectory {
  std::array<double, 3> start_m{0, 0, 0}, end_m{0, 0, 0};  ///< heading follows the line
  double speed_m_s = 1;
  double pitch_deg = 0, roll_deg = 0;
};
/// CSV with a header line: read_waypoints().
struct WaypointTrajectory {
  std::filesystem::path file;
  std::optional<double> speed_m_s;  ///< from waypoint to waypoint, in a file that has no times
  double turn_s = 60;               ///< from a line's end to the next one's beginning, likewise
};
/// Parallel lines over an area, one after the other; what lies between them is left out.
struct SurveyTrajectory {
  std::array<double, 2> centre_m{0, 0};                     ///< of the area: east, north
  std::optional<std::array<double, 2>> centre_lat_lon_deg;  ///< instead
  std::optional<std::array<double, 2>> centre_crs;          ///< instead: easting, northing
  double length_m = 0, width_m = 0;                         ///< of the area, along and across the lines
  double spacing_m = 0;                                     ///< from line to line
  double heading_deg = 0;                                   ///< of the first line
  bool one_way = false;                                     ///< all lines in the direction of the first
  double speed_m_s = 1, turn_s = 60;
  std::optional<double> up_m, depth_m, altitude_m;  ///< one of the three
  std::optional<double> altitude_step_m;            ///< way from height to height; else as altitude_m
  double pitch_deg = 0, roll_deg = 0;
};

struct TrajectoryDescription {
  SourcePlace place;
  std::string name = "trajectory";
  std::variant<FixedTrajectory, LineTrajectory, WaypointTrajectory, SurveyTrajectory> kind;
};

}  // namespace tubefoot
