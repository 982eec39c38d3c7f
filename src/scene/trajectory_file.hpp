// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "scene/description/scene_description.hpp"
#include "scene/trajectory.hpp"

namespace tubefoot {

/// Reads waypoints from a CSV file: a header line that names, in any order, time_s, east_m, north_m, up_m,
/// heading_deg, pitch_deg and roll_deg (further columns are ignored), then one row a waypoint, times
/// increasing. Blank lines and lines that start with # are skipped. Throws InputError "file:line:column:
/// ...".
Trajectory read_waypoints(const std::filesystem::path& file);

/// The trajectory that a scene describes. Throws InputError at the description's place.
Trajectory make_trajectory(const TrajectoryDescription& description);

}  // namespace tubefoot
