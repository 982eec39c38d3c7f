// SPDX-License-Identifier: GPL-3.0-or-later
// What two engines see, whatever they say of its energy: first returns, shadows, what is visible.
#pragma once

#include "compare/measures/echo_errors.hpp"
#include "compare/measures/noise_floor.hpp"

namespace tubefoot {

/// Two masks of bins.
struct Overlap {
  std::size_t reference = 0, candidate = 0, both = 0;  ///< bins of each, and in common
  /// Intersection over union; 1 where both are empty.
  double iou() const {
    const std::size_t either = reference + candidate - both;
    return either > 0 ? static_cast<double>(both) / static_cast<double>(either) : 1;
  }
};

struct GeometryErrors {
  double reference_threshold_j = 0, candidate_threshold_j = 0;  ///< above it, a bin is lit: each side its own
  NoiseFloor floor;                                             ///< the candidate's
  FirstReturnErrors first_return;                               ///< steady ones, if the candidate has noise
  Overlap shadow;   ///< bins that are not lit and lie before the reference's last lit one of their beam
  Overlap visible;  ///< lit bins
};

/// `candidate_threshold_j`: instead of lit_threshold_above() the noise floor.
GeometryErrors geometry_errors(const EchoPair& pair, std::optional<double> candidate_threshold_j = {});

}  // namespace tubefoot
