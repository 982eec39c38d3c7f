// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/water/absorption.hpp"

#include <cmath>

namespace tubefoot {
namespace {

/// Relaxation term, which rises with the square of the frequency and levels off above the relaxation
/// frequency.
double relaxation(double relaxation_khz, double frequency_khz) {
  const double f2 = frequency_khz * frequency_khz;
  return relaxation_khz * f2 / (relaxation_khz * relaxation_khz + f2);
}

double pure_water_coefficient(double t) {
  // At 20 degrees the two branches of the paper differ by 1e-7 (0.03 %).
  if (t <= 20) return 4.937e-4 + t * (-2.59e-5 + t * (9.11e-7 - t * 1.50e-8));
  return 3.964e-4 + t * (-1.146e-5 + t * (1.45e-7 - t * 6.5e-10));
}

}  // namespace

double francois_garrison_absorption_db_per_km(double frequency_khz, double temperature_c, double salinity_psu,
                                              double depth_m, double ph) {
  const double c = 1412 + 3.21 * temperature_c + 1.19 * salinity_psu + 0.0167 * depth_m;
  return francois_garrison_absorption_db_per_km(frequency_khz, temperature_c, salinity_psu, depth_m, ph, c);
}

double francois_garrison_absorption_db_per_km(double frequency_khz, double temperature_c, double salinity_psu,
                                              double depth_m, double ph, double sound_speed_m_s) {
  const double t = temperature_c, s = salinity_psu, d = depth_m, c = sound_speed_m_s;
  const double kelvin = t + 273;  // value of the paper, which fitted its constants with 273, not 273.15

  const double boric_khz = 2.8 * std::sqrt(s / 35) * std::pow(10, 4 - 1245 / kelvin);
  const double boric = 8.86 / c * std::pow(10, 0.78 * ph - 5) * relaxation(boric_khz, frequency_khz);

  const double sulphate_khz = 8.17 * std::pow(10, 8 - 1990 / kelvin) / (1 + 0.0018 * (s - 35));
  const double sulphate_pressure = 1 - 1.37e-4 * d + 6.2e-9 * d * d;
  const double sulphate =
      21.44 * s / c * (1 + 0.025 * t) * sulphate_pressure * relaxation(sulphate_khz, frequency_khz);

  const double water_pressure = 1 - 3.83e-5 * d + 4.9e-10 * d * d;
  const double water = pure_water_coefficient(t) * water_pressure * frequency_khz * frequency_khz;
  return boric + sulphate + water;
}

double ainslie_mccolm_absorption_db_per_km(double frequency_khz, double temperature_c, double salinity_psu,
                                           double depth_m, double ph) {
  const double t = temperature_c, s = salinity_psu, km = depth_m / 1000;
  const double boric_khz = 0.78 * std::sqrt(s / 35) * std::exp(t / 26);
  const double sulphate_khz = 42 * std::exp(t / 17);
  return 0.106 * relaxation(boric_khz, frequency_khz) * std::exp((ph - 8) / 0.56) +
         0.52 * (1 + t / 43) * (s / 35) * relaxation(sulphate_khz, frequency_khz) * std::exp(-km / 6) +
         0.00049 * frequency_khz * frequency_khz * std::exp(-(t / 27 + km / 17));
}

}  // namespace tubefoot
