// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/scattering/range_samples.hpp"

namespace tubefoot {

std::vector<double> sample_borders_m(const RangeSamples& samples) {
  std::vector<double> borders;
  if (samples.count >= 0) borders.reserve(std::size_t(samples.count) + 1);
  for (int k = 0; k <= samples.count; ++k) borders.push_back(samples.border_m(k));
  return borders;
}

}  // namespace tubefoot
