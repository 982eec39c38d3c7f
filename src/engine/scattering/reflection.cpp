// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/scattering/reflection.hpp"

#include <cmath>

namespace tubefoot {
namespace {

/// Returns the square root with a real part that is not negative. The function of the standard library calls
/// the C library's csqrt, whose last bit depends on the processor (cmake/mathematics.cmake).
std::complex<double> principal_root(std::complex<double> z) {
  const double larger = std::sqrt((std::hypot(z.real(), z.imag()) + std::abs(z.real())) / 2);
  if (larger == 0) return 0;
  const double smaller = std::abs(z.imag()) / (2 * larger);
  return z.real() >= 0 ? std::complex<double>(larger, std::copysign(smaller, z.imag()))
                       : std::complex<double>(smaller, std::copysign(larger, z.imag()));
}

}  // namespace

std::complex<double> reflection_coefficient(const FluidSediment& seabed, double grazing_rad) {
  const double sine = std::sin(grazing_rad), cosine = std::cos(grazing_rad);
  // The slowness relative to that of the water. The root of its square has a positive real part, and its
  // imaginary part then gives the wave's decay.
  const std::complex<double> slowness = std::complex<double>(1, seabed.loss) / seabed.speed_ratio;
  const std::complex<double> p = principal_root(slowness * slowness - cosine * cosine);
  const std::complex<double> across = seabed.density_ratio * sine;
  if (across + p == 0.0) return -1;  // along a seabed with the sound speed of the water
  return (across - p) / (across + p);
}

}  // namespace tubefoot
