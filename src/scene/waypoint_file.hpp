// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scene/description/trajectory_description.hpp"
#include "scene/survey_lines.hpp"
#include "scene/trajectory.hpp"

namespace tubefoot {

/// Reads waypoints from a CSV file with a header line and columns in any order. read_csv() describes the
/// treatment of further columns. The known columns are
/// - time_s, increasing; without this column the carrier moves between waypoints at the given speed;
/// - east_m and north_m, or latitude_deg and longitude_deg, or easting and northing (in the scene's CRS);
/// - up_m, or depth_m (below the water surface), or altitude_m (above the terrain);
/// - heading_deg, by default along the track; pitch_deg and roll_deg, by default 0;
/// - line, a whole number; where it changes the carrier turns, and no sensor pings.
/// Blank lines and lines that start with # are skipped. Throws InputError "file:line:column: ...".
Trajectory read_waypoints(const WaypointTrajectory& waypoints, const TrackSurroundings& around);

}  // namespace tubefoot
