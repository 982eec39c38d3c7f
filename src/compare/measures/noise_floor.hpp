// SPDX-License-Identifier: GPL-3.0-or-later
// What an engine says where there is nothing to receive: its noise floor, and first returns that noise does
// not ruin. Pure functions over arrays.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "compare/measures/echo_errors.hpp"

namespace tubefoot {

/// Bins that are well inside of what the reference has dark: its energy is 0 there and in all bins at most
/// `samples` samples and `beams` beams away. A shift or a blur of that much puts nothing there.
std::vector<bool> deep_shadow(const EchoShape& shape, std::span<const double> reference_j, std::size_t beams,
                              std::size_t samples);

/// What the candidate has in the deep shadow.
struct NoiseFloor {
  std::size_t bins = 0;  ///< the deep shadow's, of which this is estimated
  double mean_j = 0;     ///< robust: the mean of what is not an echo (an object without shadow, a leak)
  double deviation_j = 0;
  double mean_error_j = 0;    ///< standard error of the mean, from the spread between groups of beams
  double share_positive = 0;  ///< of the bins; 0 for a silent engine, about a half for noise clipped at 0
};

/// `shadow` as of deep_shadow(). Bins above the mean by more than six deviations are no noise and left out,
/// until none is. Up to 40 % of the shadow may be wrongly lit, and all of that behind the beams' first
/// echoes.
NoiseFloor noise_floor(const EchoShape& shape, std::span<const double> energy_j,
                       const std::vector<bool>& shadow);

/// What of an energy is above the noise: mean + 4 deviations, but at least lit_threshold() of what is left.
double lit_threshold_above(const NoiseFloor& floor, std::span<const double> energy_j);

/// The mean of every `frames` pings that follow one another. Throws std::invalid_argument unless they divide
/// the number of pings.
std::vector<double> mean_of_frames(const EchoShape& shape, std::span<const double> energy_j,
                                   std::size_t frames);

/// Per ping and beam, the first sample above `threshold_j` of which the next one or the one after it is above
/// it too: a single noisy bin is no return. With `single`, any will do (first_returns() of echo_errors.hpp).
FirstReturns steady_first_returns(const EchoShape& shape, std::span<const double> energy_j,
                                  double threshold_j, bool single);

}  // namespace tubefoot
