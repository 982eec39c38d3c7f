// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <optional>

#include "engine/scattering/sediment.hpp"

namespace tubefoot {

/// What a smooth surface leaves of a wave that it reflects, in phase with it. Time goes with e^{-i omega t}.
struct SmoothSurface {
  /// Pressure reflection coefficient: +1 rigid, -1 pressure release. Not read where there is a `fluid`.
  std::complex<double> reflection = 1;
  /// A half-space of a fluid (reflection_coefficient()).
  std::optional<FluidSediment> fluid{};
  /// Standard deviation s of its height [m]: a Gaussian surface's mean field is e^{-q_n^2 s^2 / 2} of a plane
  /// one's, q_n being the wave vector's change along the normal (Eckart 1953). What else is scattered has no
  /// phase that is kept, and is not here.
  double roughness_m = 0;

  /// The factor of both. `sine`: the mean of the sines of both ways' grazing angles, which is q_n / 2k; where
  /// the wave is reflected as by a mirror it is the sine of either, elsewhere it keeps reciprocity. `k` in
  /// rad/m.
  std::complex<double> factor(double sine, double k) const;
};

}  // namespace tubefoot
