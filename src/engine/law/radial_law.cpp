// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/law/radial_law.hpp"

#include <cmath>
#include <numbers>

namespace tubefoot {

std::vector<double> sample_borders_m(const RangeSamples& samples) {
  std::vector<double> borders;
  for (int k = 0; k <= samples.count; ++k) borders.push_back(samples.first_m + k * samples.step_m);
  return borders;
}

double two_way_absorption_per_m(double absorption_db_per_m) {
  return 2 * absorption_db_per_m * std::numbers::ln10 / 10;
}

RadialIntegral lambert_radial_integral(const RangeSamples& samples, double absorption_db_per_m) {
  const double beta = two_way_absorption_per_m(absorption_db_per_m);
  return RadialIntegral(sample_borders_m(samples), [beta](double r) {
    const double r2 = r * r;
    return std::exp(-beta * r) / (r2 * r2 * r2);
  });
}

}  // namespace tubefoot
