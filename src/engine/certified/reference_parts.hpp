// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <map>
#include <vector>

#include "engine/certified/reference.hpp"
#include "geometry/numbers/interval.hpp"

// Common parts of references for one apex and for two. Include this heavy header only in .cpp files.
namespace tubefoot {

constexpr double least_allowed = 1e-300;

/// Enclosures by bin, for one task.
using Bins = std::map<std::size_t, Ball>;

/// Enclosures by bin, summed over many tasks in their order. Only samples with contributions have rows.
class BinSums {
 public:
  BinSums(std::size_t beams, std::size_t samples) : beams_(beams), rows_(samples) {}

  Interval& at(std::size_t beam, std::size_t sample) {
    std::vector<Interval>& row = rows_[sample];
    if (row.empty()) row.resize(beams_);
    return row[beam];
  }
  /// `total`: by beam, then by sample.
  void add_to(std::vector<Interval>& total) const {
    for (std::size_t sample = 0; sample < rows_.size(); ++sample)
      for (std::size_t beam = 0; beam < rows_[sample].size(); ++beam) {
        const Interval& part = rows_[sample][beam];
        if (part.hi != 0 || part.lo != 0) total[beam * rows_.size() + sample] += part;
      }
  }

 private:
  std::size_t beams_;
  std::vector<std::vector<Interval>> rows_;
};

/// Converts enclosures to energies and bounds, and compares the bounds with a tolerance.
CertifiedEcho enclosed_echo(const Echo& ordinary, const std::vector<Ball>& total, double tolerance);

/// Repeats the enclosure until the tolerance is met, at most twice. The distribution of a bin's tolerance
/// over its parts is a guess, which may fail for a bin with very many small parts. Each repetition narrows
/// all parts by the ratio that the worst bin requires. `enclose(working, coarse)` encloses the parts to
/// `working` and sets `coarse` if a narrower try would not help.
CertifiedEcho refined_until_tolerance(double tolerance,
                                      const std::function<CertifiedEcho(double, bool&)>& enclose);

}  // namespace tubefoot
