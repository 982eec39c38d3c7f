// SPDX-License-Identifier: GPL-3.0-or-later
// Noise floor of an engine in bins without echo, and first returns that are robust against noise. Pure
// functions over arrays.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "compare/measures/echo_errors.hpp"

namespace tubefoot {

/// Returns the bins deep inside the shadow of the reference. The energy of the reference is 0 in such a bin
/// and in all bins at most `samples` samples and `beams` beams away. A shift or a blur of this size adds no
/// energy there.
std::vector<bool> deep_shadow(const EchoShape& shape, std::span<const double> reference_j, std::size_t beams,
                              std::size_t samples);

/// Statistics of the candidate in the deep shadow.
struct NoiseFloor {
  std::size_t bins = 0;  ///< number of bins of the deep shadow
  double mean_j = 0;  ///< robust mean, without bins that contain an echo (an object without shadow, a leak)
  double deviation_j = 0;
  double mean_error_j = 0;  ///< standard error of the mean, from the spread between groups of beams
  /// Share of the bins above 0: 0 for an engine without noise, about one half for noise clipped at 0.
  double share_positive = 0;
};

/// Estimates the noise floor; `shadow` is the result of deep_shadow(). Bins that exceed the mean by more
/// than six standard deviations contain echoes. They are excluded repeatedly until none is left. The
/// estimate tolerates echoes in up to 40 % of the shadow and in all bins behind the first echoes of the
/// beams.
NoiseFloor noise_floor(const EchoShape& shape, std::span<const double> energy_j,
                       const std::vector<bool>& shadow);

/// Returns the threshold of energies above noise: mean + 4 standard deviations, but at least
/// lit_threshold() of the energies without noise.
double lit_threshold_above(const NoiseFloor& floor, std::span<const double> energy_j);

/// Returns the means of `frames` consecutive pings. Throws std::invalid_argument if `frames` does not
/// divide the number of pings.
std::vector<double> mean_of_frames(const EchoShape& shape, std::span<const double> energy_j,
                                   std::size_t frames);

/// Returns, per ping and beam, the first sample above `threshold_j` for which one of the next two samples
/// is above it too. A single noisy bin is thus not a return. With `single`, a single bin suffices, as in
/// first_returns() of echo_errors.hpp.
FirstReturns steady_first_returns(const EchoShape& shape, std::span<const double> energy_j,
                                  double threshold_j, bool single);

}  // namespace tubefoot
