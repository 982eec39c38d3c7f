// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace tubefoot {

/// Sound speed of sea water [m/s] by Mackenzie, JASA 70 (1981) 807; standard error 0.07 m/s for temperatures
/// of -2 to 30 degrees Celsius, salinities of 25 to 40 PSU and depths (positive down) of 0 to 8000 m.
/// Outside of that box it is an extrapolation.
double mackenzie_sound_speed_m_s(double temperature_c, double salinity_psu, double depth_m);

/// Sound speed of sea water [m/s] by Leroy, Robinson & Goldsmith, JASA 124 (2008) 2774, equation 2; within
/// 0.2 m/s for all oceans and open seas, salinities up to 42 PSU and depths up to 12000 m. Latitude (either
/// hemisphere) enters through the pressure at a depth.
double leroy_sound_speed_m_s(double temperature_c, double salinity_psu, double depth_m, double latitude_deg);

}  // namespace tubefoot
