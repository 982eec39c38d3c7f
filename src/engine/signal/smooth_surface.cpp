// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/signal/smooth_surface.hpp"

#include <algorithm>
#include <cmath>

#include "engine/scattering/reflection.hpp"

namespace tubefoot {

std::complex<double> SmoothSurface::factor(double sine, double k) const {
  const std::complex<double> mirror =
      fluid ? reflection_coefficient(*fluid, std::asin(std::clamp(sine, 0.0, 1.0))) : reflection;
  const double change = 2 * k * sine * roughness_m;
  return mirror * std::exp(-change * change / 2);
}

}  // namespace tubefoot
