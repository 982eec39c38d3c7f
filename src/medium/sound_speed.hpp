// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace tubefoot {

/// Sound speed of sea water [m/s] by Mackenzie, JASA 70 (1981) 807; standard error 0.07 m/s for temperatures
/// of -2 to 30 degrees Celsius, salinities of 25 to 40 PSU and depths (positive down) of 0 to 8000 m.
/// Outside of that box it is an extrapolation.
double mackenzie_sound_speed_m_s(double temperature_c, double salinity_psu, double depth_m);

}  // namespace tubefoot
