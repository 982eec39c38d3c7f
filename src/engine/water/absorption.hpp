// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace tubefoot {

/// Returns the absorption of sound in sea water, in dB/km one way, by Francois & Garrison, JASA 72 (1982)
/// 896 and 1879. The terms are boric acid, magnesium sulphate and pure water. The error is about 5 % for 10
/// to 500 kHz, -2 to 22 degrees Celsius and 30 to 35 PSU. Depths (positive down) range from 0 to 3500 m.
/// Above 1 MHz the result is an extrapolation with the square of the frequency. Fresh water (salinity 0) is
/// allowed. The frequency must be above 0.
double francois_garrison_absorption_db_per_km(double frequency_khz, double temperature_c, double salinity_psu,
                                              double depth_m, double ph);

/// Does the same for a given sound speed in m/s. The other overload uses the rough value 1412 + 3.21 T +
/// 1.19 S + 0.0167 D of the paper.
double francois_garrison_absorption_db_per_km(double frequency_khz, double temperature_c, double salinity_psu,
                                              double depth_m, double ph, double sound_speed_m_s);

/// Returns the absorption of sound in sea water, in dB/km one way, by Ainslie & McColm, JASA 103 (1998)
/// 1671. This shorter formula describes the same three processes. It agrees within about 10 % with Francois
/// & Garrison for 0.1 to 1000 kHz, -6 to 35 degrees Celsius, 5 to 50 PSU and pH 7.7 to 8.3. Depths (positive
/// down) range from 0 to 7000 m. The frequency must be above 0.
double ainslie_mccolm_absorption_db_per_km(double frequency_khz, double temperature_c, double salinity_psu,
                                           double depth_m, double ph);

}  // namespace tubefoot
