// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

// Density of the mean product of two channels' signals, per square metre of independent scatterers:
//
//     sqrt(e_a e_b) exp(i k (L_a - L_b))
//
// Here e is the energy density of a channel with all its factors (density.hpp), L the length of its path and
// k the wavenumber. The energy of a channel is the case a = b. See docs/notes/signals.md.
namespace tubefoot {

/// Mean product of two signals: its size without interference, and its real and imaginary part.
struct PairDensity {
  double size, real, imag;

  /// `common`: factor of both energies, for example of the texture. Its sign is that of the product of the
  /// two amplitudes.
  static PairDensity of(double energy_a, double energy_b, double phase_rad, double common = 1) {
    const double size = std::sqrt(energy_a * energy_b) * common;
    return {std::abs(size), size * std::cos(phase_rad), size * std::sin(phase_rad)};
  }
};

/// Range of a point from one end minus its range from another, as (a^2 - b^2) / (a + b). This form has no
/// cancellation for ends that are close together. `along`: scalar product of the vector from the middle of
/// the ends to the point and the vector from the second end to the first. `sum`: sum of both ranges.
inline double range_difference(double along, double sum) { return -2 * along / sum; }

}  // namespace tubefoot
