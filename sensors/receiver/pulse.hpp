// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "engine/scattering/range_samples.hpp"

namespace tubefoot {

/// Slant range [m] over which a pulse spreads an echo: c tau / 2.
double pulse_extent_m(double pulse_length_us, double sound_speed_m_s);

/// Distributes the energies of a ping, [beam][sample], over a pulse of that extent. An echo from range r
/// spreads uniformly over [r, r + extent), because the end of the pulse arrives that much later than its
/// start. A sample's energy counts as uniform over the sample. The sum is preserved, except for energy
/// beyond a beam's last sample. Throws std::invalid_argument for a negative or non-finite extent, and for
/// incomplete beams.
std::vector<double> spread_over_pulse(std::span<const double> energies, const RangeSamples& samples,
                                      double extent_m);

}  // namespace tubefoot
