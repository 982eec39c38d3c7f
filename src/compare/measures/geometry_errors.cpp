// SPDX-License-Identifier: GPL-3.0-or-later
#include "compare/measures/geometry_errors.hpp"

namespace tubefoot {
namespace {

// Displacement or blur of an echo that does not count as noise.
constexpr std::size_t reach_beams = 2, reach_samples = 3;

}  // namespace

GeometryErrors geometry_errors(const EchoPair& pair, std::optional<double> candidate_threshold_j) {
  const EchoShape& shape = pair.shape;
  GeometryErrors errors;
  errors.floor =
      noise_floor(shape, pair.candidate_j, deep_shadow(shape, pair.reference_j, reach_beams, reach_samples));
  errors.reference_threshold_j = lit_threshold(pair.reference_j);
  errors.candidate_threshold_j =
      candidate_threshold_j.value_or(lit_threshold_above(errors.floor, pair.candidate_j));
  const bool silent = errors.floor.deviation_j == 0;
  errors.first_return = first_return_errors(
      pair, steady_first_returns(shape, pair.reference_j, errors.reference_threshold_j, silent),
      steady_first_returns(shape, pair.candidate_j, errors.candidate_threshold_j, silent));
  for (std::size_t k = 0; k < shape.pings * shape.beams; ++k) {
    bool before_last = false;
    for (std::size_t bin = (k + 1) * shape.samples; bin-- > k * shape.samples;) {
      const bool r = pair.reference_j[bin] > errors.reference_threshold_j,
                 c = pair.candidate_j[bin] > errors.candidate_threshold_j;
      before_last = before_last || r;
      errors.visible.reference += r;
      errors.visible.candidate += c;
      errors.visible.both += r && c;
      if (!before_last) continue;
      errors.shadow.reference += !r;
      errors.shadow.candidate += !c;
      errors.shadow.both += !r && !c;
    }
  }
  return errors;
}

}  // namespace tubefoot
