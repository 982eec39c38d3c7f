// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/model/beam_angles.hpp"

#include <cmath>

#include "sensors/model/angles.hpp"

namespace tubefoot {

std::vector<double> spread_angles_rad(int beams, double outermost_rad, std::string_view spacing) {
  if (beams == 1) return {0};
  std::vector<double> angles;
  for (int beam = 0; beam < beams; ++beam) {
    // A quotient of integers: exactly 0 in the middle and -1 and 1 at the ends.
    const double place = static_cast<double>(2 * beam - (beams - 1)) / (beams - 1);
    angles.push_back(spacing == "distance" ? std::atan(place * std::tan(outermost_rad))
                                           : place * outermost_rad);
  }
  return angles;
}

std::vector<double> radians_of(const std::vector<double>& angles_deg) {
  std::vector<double> angles;
  for (const double angle : angles_deg) angles.push_back(radians(angle));
  return angles;
}

bool tells_beams_apart(const PatternDescription& receive, std::string_view shared_angle) {
  if (receive.pattern == "none") return false;
  return receive.pattern == "piston" || receive.angle != shared_angle;  // a piston has a single angle
}

}  // namespace tubefoot
