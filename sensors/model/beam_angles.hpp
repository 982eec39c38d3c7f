// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "scene/description/sensor_description.hpp"

// Where the beams of a fan lie, and whether its receivers tell them apart.
namespace tubefoot {

/// Angles from the fan's middle, port first, from -`outermost` to `outermost`; exactly 0 in the middle of an
/// odd number. `spacing`: "angle": equal steps of angle; "distance": of tangent, which are equal distances
/// along a straight line across.
std::vector<double> spread_angles_rad(int beams, double outermost_rad, std::string_view spacing);

std::vector<double> radians_of(const std::vector<double>& angles_deg);

/// A receive pattern over the angle that all beams of a fan share ("elevation" of fans ahead, "azimuth" of
/// fans across the track) is the same for all of them: they stay ideal, each with tubes of its own.
bool tells_beams_apart(const PatternDescription& receive, std::string_view shared_angle);

}  // namespace tubefoot
