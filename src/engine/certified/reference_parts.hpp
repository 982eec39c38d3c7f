// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <map>
#include <vector>

#include "engine/certified/reference.hpp"
#include "geometry/numbers/interval.hpp"

// What references of one apex and of two have in common. Heavy: include only in .cpp files.
namespace tubefoot {

constexpr double least_allowed = 1e-300;

/// Enclosures by bin, of one task.
using Bins = std::map<std::size_t, Ball>;

/// Enclosures by bin of many tasks, added up in their order. Only samples that something is in have rows.
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

/// Energies and bounds of enclosures, held against a tolerance.
CertifiedEcho enclosed_echo(const Echo& ordinary, const std::vector<Ball>& total, double tolerance);

/// How a bin's tolerance is shared out among its parts is a guess, which a bin of very many small parts may
/// prove wrong: then all of them are done again, as much narrower as that bin needs, at most twice.
/// `enclose(working, coarse)`: parts enclosed to `working`; `coarse`: no narrower try would help.
CertifiedEcho refined_until_tolerance(double tolerance,
                                      const std::function<CertifiedEcho(double, bool&)>& enclose);

}  // namespace tubefoot
