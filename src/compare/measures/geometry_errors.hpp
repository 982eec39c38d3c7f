// SPDX-License-Identifier: GPL-3.0-or-later
// Errors of the geometry that two engines see, independent of energies: first returns, shadows, visible
// bins.
#pragma once

#include "compare/measures/echo_errors.hpp"
#include "compare/measures/noise_floor.hpp"

namespace tubefoot {

/// Overlap of two sets of bins.
struct Overlap {
  /// Number of bins of each set, and of their intersection.
  std::size_t reference = 0, candidate = 0, both = 0;
  /// Intersection over union; 1 if both are empty.
  double iou() const {
    const std::size_t either = reference + candidate - both;
    return either > 0 ? static_cast<double>(both) / static_cast<double>(either) : 1;
  }
};

struct GeometryErrors {
  /// Energies above which a bin is insonified, one per side.
  double reference_threshold_j = 0, candidate_threshold_j = 0;
  NoiseFloor floor;                ///< noise floor of the candidate
  FirstReturnErrors first_return;  ///< steady first returns if the candidate has noise
  Overlap shadow;   ///< bins that are not insonified and lie before the last insonified bin of the reference
                    ///< in their beam
  Overlap visible;  ///< insonified bins
};

/// `candidate_threshold_j` replaces the threshold that lit_threshold_above() derives from the noise floor.
GeometryErrors geometry_errors(const EchoPair& pair, std::optional<double> candidate_threshold_j = {});

}  // namespace tubefoot
