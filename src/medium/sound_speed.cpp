// SPDX-License-Identifier: GPL-3.0-or-later
#include "medium/sound_speed.hpp"

namespace tubefoot {

double mackenzie_sound_speed_m_s(double temperature_c, double salinity_psu, double depth_m) {
  const double t = temperature_c, s = salinity_psu - 35, d = depth_m;
  return 1448.96 + t * (4.591 + t * (-5.304e-2 + t * 2.374e-4)) + 1.340 * s + d * (1.630e-2 + d * 1.675e-7) -
         1.025e-2 * t * s - 7.139e-13 * t * d * d * d;
}

}  // namespace tubefoot
