// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/model/interferometric.hpp"

#include "sensors/model/angles.hpp"

namespace tubefoot {

Interferometric::Interferometric(const SensorDescription& description)
    : Sidescan(description, std::get<InterferometricDescription>(description.kind)) {
  const auto& staff = std::get<InterferometricDescription>(description.kind);
  require(staff.baseline_m > 0 && staff.baseline_m <= staff.range_min_m, description, "baseline_m",
          staff.baseline_m, "above 0 and at most range_min_m");
  baseline_m_ = staff.baseline_m;
  const double tilt_rad = radians(staff.staff_tilt_deg);
  for (Fan& fan : shots_.front().fans) {
    const double side = fan.first_beam == 0 ? -1.0 : 1.0;
    fan.staff = std::sin(tilt_rad) * side * starboard_axis + std::cos(tilt_rad) * up_axis;
  }
}

}  // namespace tubefoot
