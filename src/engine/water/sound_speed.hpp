// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace tubefoot {

/// Returns the sound speed of sea water in m/s by Mackenzie, JASA 70 (1981) 807. The standard error is 0.07
/// m/s for -2 to 30 degrees Celsius, 25 to 40 PSU and depths (positive down) of 0 to 8000 m. Outside of
/// these limits the result is an extrapolation.
double mackenzie_sound_speed_m_s(double temperature_c, double salinity_psu, double depth_m);

/// Returns the sound speed of sea water in m/s by Leroy, Robinson & Goldsmith, JASA 124 (2008) 2774,
/// equation 2. The error is at most 0.2 m/s in all oceans and open seas, for salinities up to 42 PSU and
/// depths up to 12000 m. The latitude (of either hemisphere) determines the pressure at a depth.
double leroy_sound_speed_m_s(double temperature_c, double salinity_psu, double depth_m, double latitude_deg);

}  // namespace tubefoot
