// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace tubefoot {

/// Absorption of sound in sea water [dB/km, one way] by Francois & Garrison, JASA 72 (1982) 896 and 1879:
/// boric acid, magnesium sulphate, pure water. About 5 % for 10 to 500 kHz, -2 to 22 degrees Celsius, 30 to
/// 35 PSU and depths (positive down) of 0 to 3500 m; above 1 MHz it is an extrapolation by frequency squared.
/// Fresh water (salinity 0) is allowed. Frequency > 0.
double francois_garrison_absorption_db_per_km(double frequency_khz, double temperature_c, double salinity_psu,
                                              double depth_m, double ph);

/// The same with the sound speed [m/s] given, instead of the paper's own rough 1412 + 3.21 T + 1.19 S +
/// 0.0167 D.
double francois_garrison_absorption_db_per_km(double frequency_khz, double temperature_c, double salinity_psu,
                                              double depth_m, double ph, double sound_speed_m_s);

/// Absorption of sound in sea water [dB/km, one way] by Ainslie & McColm, JASA 103 (1998) 1671: a shorter
/// formula for the same three processes, within about 10 % of Francois & Garrison for 0.1 to 1000 kHz, -6 to
/// 35 degrees Celsius, 5 to 50 PSU, pH 7.7 to 8.3 and depths (positive down) of 0 to 7000 m. Frequency > 0.
double ainslie_mccolm_absorption_db_per_km(double frequency_khz, double temperature_c, double salinity_psu,
                                           double depth_m, double ph);

}  // namespace tubefoot
