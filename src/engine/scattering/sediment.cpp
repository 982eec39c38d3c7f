// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/scattering/sediment.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace tubefoot {
namespace {

constexpr std::array<SedimentBackscatter, 16> tables{{
    {"rough rock", 300, {-25.42, -16.89, -13.12, -11.41, -13.81, -21.89, -10.92, -10.81}},
    {"rock", 300, {-29.54, -20.16, -14.75, -13.46, -14.04, -20.98, -12.41, -12.17}},
    {"cobble", 300, {-31.90, -21.30, -12.37, -11.44, -16.37, -17.09, -17.01, -16.78}},
    {"sandy gravel", 300, {-29.36, -19.10, -11.96, -11.18, -16.64, -21.23, -22.74, -22.84}},
    {"coarse sand", 300, {-37.45, -26.87, -18.64, -14.97, -15.08, -15.03, -15.45, -15.55}},
    {"medium sand", 300, {-40.51, -29.84, -21.59, -18.21, -18.66, -16.76, -14.87, -14.64}},
    {"fine sand", 300, {-45.44, -34.51, -25.51, -23.50, -22.60, -20.44, -16.04, -15.14}},
    {"silt", 300, {-41.30, -35.68, -31.77, -29.93, -28.34, -27.35, -24.02, -15.35}},
    {"rough rock", 20, {-30.59, -20.69, -13.65, -11.40, -11.09, -11.94, -6.64, -4.49}},
    {"rock", 20, {-35.07, -25.18, -17.27, -13.53, -12.76, -11.50, -6.15, -4.64}},
    {"cobble", 20, {-38.18, -28.27, -20.30, -16.98, -14.34, -12.82, -7.66, -5.98}},
    {"sandy gravel", 20, {-41.08, -30.78, -22.91, -19.55, -17.82, -16.11, -8.43, -4.88}},
    {"coarse sand", 20, {-45.73, -35.72, -27.51, -23.93, -21.90, -19.42, -8.12, -2.07}},
    {"medium sand", 20, {-47.99, -38.08, -29.75, -25.68, -23.55, -21.76, -11.04, -1.09}},
    {"fine sand", 20, {-50.35, -39.78, -30.12, -25.36, -24.33, -23.32, -16.30, -1.69}},
    {"silt", 20, {-41.37, -35.73, -31.81, -29.97, -28.39, -27.48, -26.45, -1.55}},
}};

}  // namespace

const std::vector<std::string_view>& sediment_names() {
  static const std::vector<std::string_view> names = [] {
    std::vector<std::string_view> all;
    for (const SedimentBackscatter& table : tables)
      if (table.frequency_khz == 300) all.push_back(table.name);
    return all;
  }();
  return names;
}

const SedimentBackscatter& sediment_backscatter(std::string_view name, double frequency_khz) {
  for (const SedimentBackscatter& table : tables)
    if (table.name == name && table.frequency_khz == frequency_khz) return table;
  throw std::invalid_argument(
      fmt::format("there is no backscatter table for '{}' at {} kHz: tables exist for 20 and 300 kHz", name,
                  frequency_khz));
}

FluidSediment sediment_of_grain_size(double m) {
  if (!(m >= -1 && m <= 9))
    throw std::invalid_argument(fmt::format("the mean grain size must be from -1 to 9 phi, not {}", m));
  FluidSediment seabed;
  if (m < 1) {
    seabed.density_ratio = (0.007797 * m - 0.17057) * m + 2.3139;
    seabed.speed_ratio = (0.002709 * m - 0.056452) * m + 1.2778;
  } else if (m < 5.3) {
    seabed.density_ratio = ((-0.0165406 * m + 0.2290201) * m - 1.1069031) * m + 3.0455;
    seabed.speed_ratio = ((-0.0014881 * m + 0.0213937) * m - 0.1382798) * m + 1.3425;
  } else {
    seabed.density_ratio = 1.1565 - 0.0012973 * m;
    seabed.speed_ratio = 1.0019 - 0.0024324 * m;
  }
  const double k = m < 0     ? 0.4556  // dB / m / kHz
                   : m < 2.6 ? 0.4556 + 0.0245 * m
                   : m < 4.5 ? 0.1978 + 0.1245 * m
                   : m < 6   ? 8.0399 + m * (-2.5228 + 0.20098 * m)
                             : 0.9431 + m * (-0.2041 + 0.0117 * m);
  constexpr double water_speed = 1528;
  seabed.loss = k * seabed.speed_ratio * water_speed * std::numbers::ln10 / (40000 * std::numbers::pi);
  return seabed;
}

FluidSediment fluid_sediment(double density_ratio, double speed_ratio, double attenuation_db_per_wavelength) {
  if (!(density_ratio > 0 && speed_ratio > 0 && attenuation_db_per_wavelength >= 0))
    throw std::invalid_argument(
        "a fluid seabed needs density and speed ratios above 0 and an attenuation of 0 or more");
  return {density_ratio, speed_ratio,
          attenuation_db_per_wavelength * std::numbers::ln10 / (40 * std::numbers::pi)};
}

}  // namespace tubefoot
