// SPDX-License-Identifier: GPL-3.0-or-later
// Errors of bins that several owners have energy in, split among these. Arrays only.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace tubefoot {

/// What one owner has of a bin's energy.
struct OwnerShare {
  std::uint32_t owner = 0;
  double share = 0;  ///< of a bin they add up to 1
};

/// Sums over bins, or over parts of bins.
struct ErrorSums {
  double error = 0;       ///< of |C - R|
  double difference = 0;  ///< of C - R
  double energy = 0;      ///< of R
  ErrorSums& operator+=(const ErrorSums& other);
};

/// A bin of one owner is all its. In a bin of several, an owner has of the error
///
///     (its energy there) * (its error rate) / (the sum of these over the bin's owners)
///
/// its rate being its error over its energy, in all bins: what makes the errors of all bins most likely, were
/// they counts. It is found by rounds, which begin with equal rates. So an error of one owner alone is found
/// to be its alone, if others have bins to themselves that are right. Shares add up to the whole.
class ErrorSplit {
 public:
  explicit ErrorSplit(std::size_t groups) : groups_(groups) {}
  /// `group`: another division, of whole bins. What needs no splitting takes no memory.
  void add(std::size_t group, std::span<const OwnerShare> shares, const ErrorSums& bin);
  /// By owner and group, [owner * groups + group], of at least `owners` owners.
  std::vector<ErrorSums> finish(std::size_t owners, int rounds = 200);

 private:
  struct Mixed {
    std::size_t group, first, count;
    ErrorSums bin;
  };
  ErrorSums& sums_of(std::size_t owner, std::size_t group);
  std::size_t groups_;
  std::vector<ErrorSums> sums_;  // of what is not split
  std::vector<Mixed> mixed_;
  std::vector<OwnerShare> shares_;
};

}  // namespace tubefoot
