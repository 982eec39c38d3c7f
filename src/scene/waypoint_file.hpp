// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scene/description/trajectory_description.hpp"
#include "scene/survey_lines.hpp"
#include "scene/trajectory.hpp"

namespace tubefoot {

/// Reads waypoints from a CSV file with a header line, columns in any order (others as read_csv() has it):
///   time_s, which increases; without it the carrier goes from point to point at the speed that is given;
///   east_m and north_m, or latitude_deg and longitude_deg, or easting and northing (of the scene's CRS);
///   up_m, or depth_m (below the water's surface), or altitude_m (above the terrain);
///   heading_deg, else along the track; pitch_deg and roll_deg, else 0;
///   line, a whole number: where it changes is a turn, on which no sensor pings.
/// Blank lines and lines that start with # are skipped. Throws InputError "file:line:column: ...".
Trajectory read_waypoints(const WaypointTrajectory& waypoints, const TrackSurroundings& around);

}  // namespace tubefoot
