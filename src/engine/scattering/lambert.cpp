// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/scattering/lambert.hpp"

#include <cmath>

namespace tubefoot {

double lambert_mu(double lambert_db) { return std::pow(10, lambert_db / 10); }

double lambert_cross_section(double mu, double grazing_angle_rad) {
  const double sine = std::sin(grazing_angle_rad);
  return mu * sine * sine;
}

}  // namespace tubefoot
