// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

namespace tubefoot {

/// Scattering of the water itself, constant within each of several horizontal layers.
struct VolumeScattering {
  /// Heights of the borders between layers, increasing, in metres.
  std::vector<double> borders_m;
  /// Volume scattering coefficient s_v of each layer in 1/(m sr), from the lowest layer. There is one more
  /// than `borders_m`. The volume scattering strength is S_v = 10 log10(s_v) (MacLennan, Fernandes and Dalen
  /// 2002, A consistent approach to definitions and symbols in fisheries acoustics).
  std::vector<double> s_v_per_m;

  /// Returns whether some layer scatters.
  bool any() const;
};

/// Throws std::invalid_argument for borders that do not increase, or a coefficient that is negative or not
/// finite.
void check(const VolumeScattering& volume);

/// Returns the integral of r^-2 e^(-2 beta r) dr over ranges in 1/m, to rounding. Times s_v and a solid
/// angle, it is the received energy density of the volume for 1 J/sr at 1 m. `from_m` is above 0;
/// `beta_per_m` is the one-way absorption.
double volume_spreading(double from_m, double to_m, double beta_per_m);

}  // namespace tubefoot
