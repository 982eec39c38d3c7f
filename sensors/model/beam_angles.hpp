// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "scene/description/sensor_description.hpp"

// Angles of the beams of a fan, and whether receive patterns resolve the beams.
namespace tubefoot {

/// Angles from the fan's middle, port first, from -`outermost` to `outermost`. The middle one of an odd
/// number is exactly 0. `spacing` is "angle" for equal steps of angle, or "distance" for equal steps of
/// tangent, which are equal distances along a straight line across.
std::vector<double> spread_angles_rad(int beams, double outermost_rad, std::string_view spacing);

std::vector<double> radians_of(const std::vector<double>& angles_deg);

/// True if the receive pattern differs between the beams of a fan. A pattern over the angle that all beams
/// share is the same for all of them. This angle is "elevation" for fans ahead and "azimuth" for fans across
/// the track. Such beams stay ideal, each with its own tubes.
bool tells_beams_apart(const PatternDescription& receive, std::string_view shared_angle);

}  // namespace tubefoot
