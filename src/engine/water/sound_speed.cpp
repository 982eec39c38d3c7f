// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/water/sound_speed.hpp"

#include <cmath>

namespace tubefoot {

double mackenzie_sound_speed_m_s(double temperature_c, double salinity_psu, double depth_m) {
  const double t = temperature_c, s = salinity_psu - 35, d = depth_m;
  return 1448.96 + t * (4.591 + t * (-5.304e-2 + t * 2.374e-4)) + 1.340 * s + d * (1.630e-2 + d * 1.675e-7) -
         1.025e-2 * t * s - 7.139e-13 * t * d * d * d;
}

double leroy_sound_speed_m_s(double temperature_c, double salinity_psu, double depth_m, double latitude_deg) {
  const double t = temperature_c, s = salinity_psu, z = depth_m;
  return 1402.5 + t * (5 + t * (-5.44e-2 + t * 2.1e-4)) + 1.33 * s + s * t * (-1.23e-2 + 8.7e-5 * t) +
         z * (1.56e-2 + z * (2.55e-7 - z * 7.3e-12)) + 1.2e-6 * z * (std::abs(latitude_deg) - 45) -
         9.5e-13 * t * z * z * z + 3e-7 * t * t * z + 1.43e-5 * s * z;
}

}  // namespace tubefoot
