// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "engine/scattering/range_samples.hpp"

namespace tubefoot {

/// Finds the sample that contains a range or half path.
class SampleFinder {
 public:
  explicit SampleFinder(const RangeSamples& samples)
      : samples_(samples),
        borders_(sample_borders_m(samples)),
        samples_per_m_(samples.count / (borders_.back() - borders_.front())) {}
  const RangeSamples& samples() const { return samples_; }
  const std::vector<double>& borders() const { return borders_; }
  double samples_per_m() const { return samples_per_m_; }
  bool holds(double range_m) const { return range_m >= borders_.front() && range_m < borders_.back(); }
  /// Sample of a range within all samples. The comparison with the borders decides, not the division,
  /// because footprints are cut at the same numbers.
  std::size_t at(double range_m) const {
    return from(std::min(std::size_t((range_m - borders_.front()) * samples_per_m_), borders_.size() - 2),
                range_m);
  }
  /// The same if a nearby sample is known.
  std::size_t from(std::size_t k, double range_m) const {
    while (range_m < borders_[k]) --k;
    while (range_m >= borders_[k + 1]) ++k;
    return k;
  }
  /// Samples [first, second) that contain the ranges from near to far, with one additional sample on both
  /// sides.
  std::pair<std::size_t, std::size_t> between(double near_m, double far_m) const {
    const double samples = double(borders_.size() - 1);
    const auto sample = [&](double range_m) {
      return std::clamp(std::floor((range_m - borders_.front()) * samples_per_m_), -1.0, samples);
    };
    return {std::size_t(std::max(sample(near_m) - 1, 0.0)),
            std::size_t(std::min(sample(far_m) + 2, samples))};
  }
  /// Calls take(sample, part) for the parts of [near, far] that lie in the same sample after either of two
  /// shifts. If both ends are equal, the interval is a single range.
  template <class Take>
  void share(double near_m, double far_m, double least, double most, const Take& take) const {
    if (!(far_m > near_m)) {
      if (!holds(near_m + least) || !holds(near_m + most)) return;
      const std::size_t k = at(near_m + least);
      if (k == at(near_m + most)) take(k, 1);
      return;
    }
    if (!(far_m + most > borders_.front() && near_m + least < borders_.back())) return;
    for (std::size_t k = near_m + least <= borders_.front() ? 0 : at(near_m + least);
         k + 1 < borders_.size() && borders_[k] - least < far_m; ++k) {
      const double part = std::min(far_m, borders_[k + 1] - most) - std::max(near_m, borders_[k] - least);
      if (part > 0) take(k, part / (far_m - near_m));
    }
  }

 private:
  RangeSamples samples_;
  std::vector<double> borders_;
  double samples_per_m_;
};

}  // namespace tubefoot
