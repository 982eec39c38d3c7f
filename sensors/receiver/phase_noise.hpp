// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "engine/scattering/counter_random.hpp"

// The law of the phase difference between two receivers whose fully developed speckle has the coherence g:
// two correlated complex Gaussian numbers of which one is multiplied by the other's conjugate (Middleton
// 1960; Just & Bamler, Applied Optics 33 (1994) 4361). Phases are radians about the true one. Every function
// throws std::invalid_argument for a coherence outside 0 to 1.
namespace tubefoot {

/// Probability density over (-pi, pi] of a single look. With b = g cos phi it is
/// (1 - g^2) / (2 pi (1 - b^2)) (1 + b acos(-b) / sqrt(1 - b^2)). Coherence below 1.
double phase_density(double phase_rad, double coherence);

/// Probability of a phase up to this one, single look: the density's integral in closed form,
/// 1/2 + (phi + g sin phi acos(-b) / sqrt(1 - b^2)) / (2 pi).
double phase_distribution(double phase_rad, double coherence);

/// Variance [rad^2] of a single look, pi^2/3 - pi asin g + asin^2 g - Li2(g^2) / 2. Of more looks (products
/// averaged before the phase is taken) the approximation (1 - g^2) / (2 looks g^2), but no more than of one
/// look: for many looks and small phases.
double phase_variance(double coherence, int looks = 1);

/// The error of a single look's phase, by inversion of the distribution. 0 for full coherence.
double draw_phase_error(const SampleRandom& random, double coherence);

}  // namespace tubefoot
