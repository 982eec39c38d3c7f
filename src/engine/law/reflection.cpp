// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/law/reflection.hpp"

#include <cmath>

namespace tubefoot {

std::complex<double> reflection_coefficient(const FluidSediment& bed, double grazing_rad) {
  const double sine = std::sin(grazing_rad), cosine = std::cos(grazing_rad);
  // The slowness relative to the water's; its square's root has a positive real part, and with it an
  // imaginary part of the wave's decay.
  const std::complex<double> slowness = std::complex<double>(1, bed.loss) / bed.speed_ratio;
  const std::complex<double> p = std::sqrt(slowness * slowness - cosine * cosine);
  const std::complex<double> across = bed.density_ratio * sine;
  return (across - p) / (across + p);
}

double reflected_energy(const FluidSediment& bed, double grazing_rad) {
  return std::norm(reflection_coefficient(bed, grazing_rad));
}

}  // namespace tubefoot
