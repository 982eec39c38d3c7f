// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scene/description/trajectory_description.hpp"
#include "scene/survey_lines.hpp"
#include "scene/trajectory.hpp"

namespace tubefoot {

/// Creates the trajectory of a description. Throws InputError at the place of the description.
Trajectory make_trajectory(const TrajectoryDescription& description, const TrackSurroundings& around);

}  // namespace tubefoot
