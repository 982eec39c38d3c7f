// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scene/description/trajectory_description.hpp"
#include "scene/trajectory.hpp"

namespace tubefoot {

/// Reads waypoints from a CSV file: a header line that names, in any order, time_s, east_m, north_m, up_m,
/// heading_deg, pitch_deg and roll_deg (further columns are ignored), then one row a waypoint, times
/// increasing. Blank lines and lines that start with # are skipped. Throws InputError "file:line:column:
/// ...".
Trajectory read_waypoints(const std::filesystem::path& file);

/// The trajectory that a scene describes. Throws InputError at the description's place. `odd`, if given,
/// receives what is odd about waypoints: headings that fit their way as radians and not as degrees, speeds
/// that no carrier has.
Trajectory make_trajectory(const TrajectoryDescription& description, std::vector<std::string>* odd = nullptr);

}  // namespace tubefoot
