// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "engine/scattering/counter_random.hpp"

// Distribution of the phase difference between two receivers whose fully developed speckle has the coherence
// g. The signals are two correlated complex Gaussian numbers, and the phase is that of one times the
// conjugate of the other. Sources: Middleton 1960; Just & Bamler, Applied Optics 33 (1994) 4361. Phases are
// in radians about the true phase. Every function throws std::invalid_argument for a coherence outside 0 to
// 1.
namespace tubefoot {

/// Probability density over (-pi, pi] of a single look. With b = g cos phi it is (1 - g^2) / (2 pi (1 -
/// b^2)) (1 + b acos(-b) / sqrt(1 - b^2)). Requires a coherence below 1.
double phase_density(double phase_rad, double coherence);

/// Probability of a phase up to this one, for a single look. In closed form the integral of the density is
/// 1/2 + (phi + g sin phi acos(-b) / sqrt(1 - b^2)) / (2 pi).
double phase_distribution(double phase_rad, double coherence);

/// Variance [rad^2] of a single look, pi^2/3 - pi asin g + asin^2 g - Li2(g^2) / 2. For more looks, whose
/// products are averaged before the phase is taken, the result is the approximation (1 - g^2) / (2 looks
/// g^2). It holds for many looks and small phases, and is limited to the variance of one look.
double phase_variance(double coherence, int looks = 1);

/// Draws the phase error of a single look, by inversion of the distribution. The error is 0 for full
/// coherence.
double draw_phase_error(const SampleRandom& random, double coherence);

}  // namespace tubefoot
