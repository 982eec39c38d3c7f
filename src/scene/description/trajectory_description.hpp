// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <filesystem>
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
/// CSV with a header line: time_s, east_m, north_m, up_m, heading_deg, pitch_deg, roll_deg.
struct WaypointTrajectory {
  std::filesystem::path file;
};

struct TrajectoryDescription {
  SourcePlace place;
  std::string name = "trajectory";
  std::variant<FixedTrajectory, LineTrajectory, WaypointTrajectory> kind;
};

}  // namespace tubefoot
