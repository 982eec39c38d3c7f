// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <optional>

#include "engine/scattering/sediment.hpp"

namespace tubefoot {

/// Coherent reflection of a smooth surface. The time factor is e^{-i omega t}.
struct SmoothSurface {
  /// Pressure reflection coefficient: +1 rigid, -1 pressure release. `fluid` replaces it.
  std::complex<double> reflection = 1;
  /// Half-space of a fluid (reflection_coefficient()).
  std::optional<FluidSediment> fluid{};
  /// Standard deviation s of the surface height in m. The mean field of a Gaussian surface is e^{-q_n^2 s^2
  /// / 2} times that of a plane (Eckart 1953). Here q_n is the change of the wave vector along the normal.
  /// The incoherent part is not modelled.
  double roughness_m = 0;

  /// Factor of reflection and roughness. `sine`: mean of the sines of the grazing angles of both legs, which
  /// is q_n / 2k. For specular reflection it equals the sine of either leg. Elsewhere the mean preserves
  /// reciprocity. `k`: in rad/m.
  std::complex<double> factor(double sine, double k) const;
};

}  // namespace tubefoot
