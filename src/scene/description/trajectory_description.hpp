// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>

#include "files/input_error.hpp"

// Part of the description of a scene file: scene/description/scene_description.hpp.
namespace tubefoot {

/// Pose of the carrier: position in the local frame, heading clockwise from north, pitch bow up, roll
/// starboard down.
struct FixedTrajectory {
  std::array<double, 3> position_m{0, 0, 0};
  double heading_deg = 0, pitch_deg = 0, roll_deg = 0;
};
struct LineTrajectory {
  std::array<double, 3> start_m{0, 0, 0}, end_m{0, 0, 0};  ///< the heading follows the line
  double speed_m_s = 1;
  double pitch_deg = 0, roll_deg = 0;
};
/// CSV with a header line: read_waypoints().
struct WaypointTrajectory {
  std::filesystem::path file;
  std::optional<double> speed_m_s;  ///< speed between waypoints, if the file has no times
  double turn_s = 60;  ///< duration from a line's end to the next beginning, if the file has no times
};
/// Parallel lines over an area in sequence. The turns between them are left out.
struct SurveyTrajectory {
  std::array<double, 2> centre_m{0, 0};                     ///< centre of the area: east, north
  std::optional<std::array<double, 2>> centre_lat_lon_deg;  ///< instead of centre_m
  std::optional<std::array<double, 2>> centre_crs;          ///< instead of centre_m: easting, northing
  double length_m = 0, width_m = 0;                         ///< size of the area, along and across the lines
  double spacing_m = 0;                                     ///< distance of lines
  double heading_deg = 0;                                   ///< heading of the first line
  bool one_way = false;                                     ///< all lines in the direction of the first
  double speed_m_s = 1, turn_s = 60;
  std::optional<double> up_m, depth_m, altitude_m;  ///< one of the three
  std::optional<double> altitude_step_m;  ///< distance between heights along the track; by default altitude_m
  double pitch_deg = 0, roll_deg = 0;
};

struct TrajectoryDescription {
  SourcePlace place;
  std::string name = "trajectory";
  std::variant<FixedTrajectory, LineTrajectory, WaypointTrajectory, SurveyTrajectory> kind;
};

}  // namespace tubefoot
