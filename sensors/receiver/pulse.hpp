// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "engine/scattering/range_samples.hpp"

namespace tubefoot {

/// Slant range [m] over which a pulse spreads an echo: c tau / 2.
double pulse_extent_m(double pulse_length_us, double sound_speed_m_s);

/// Energies of a ping, [beam][sample], as a pulse of that extent brings them in: what came from a range r
/// comes evenly from [r, r + extent), because the pulse's end arrives that much later than its start. A
/// sample's energy is taken as even over the sample. The sum is kept, but for what leaves a beam's last
/// sample. Throws std::invalid_argument for an extent that is negative or not finite, and unless there are
/// whole beams.
std::vector<double> spread_over_pulse(std::span<const double> energies, const RangeSamples& samples,
                                      double extent_m);

}  // namespace tubefoot
