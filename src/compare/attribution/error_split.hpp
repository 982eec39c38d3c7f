// SPDX-License-Identifier: GPL-3.0-or-later
// Splits the errors of bins in which several owners have energy. Works on arrays only.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace tubefoot {

/// Share of one owner in the energy of a bin.
struct OwnerShare {
  std::uint32_t owner = 0;
  double share = 0;  ///< the shares of a bin add up to 1
};

/// Sums over bins, or over parts of bins, for the candidate C and the reference R.
struct ErrorSums {
  double error = 0;       ///< sum of |C - R|
  double difference = 0;  ///< sum of C - R
  double energy = 0;      ///< sum of R
  ErrorSums& operator+=(const ErrorSums& other);
};

/// Splits errors between owners. A bin with one owner belongs to this owner. In a bin with several owners,
/// the share of an owner in the error is
///
///     (its energy in the bin) * (its error rate) / (the sum of these products over the owners of the bin)
///
/// The error rate of an owner is its error divided by its energy, over all bins. These shares maximise the
/// likelihood of the errors of all bins as if errors were counts. An iteration finds them and starts with
/// equal rates. If only one owner has errors and the other owners have bins of their own without error, the
/// iteration attributes all errors to this owner. The shares of a bin add up to its error.
class ErrorSplit {
 public:
  explicit ErrorSplit(std::size_t groups) : groups_(groups) {}
  /// Adds a bin. `group` is a second classification, of whole bins. A bin with a single owner takes no
  /// memory.
  void add(std::size_t group, std::span<const OwnerShare> shares, const ErrorSums& bin);
  /// Returns the sums by owner and group, [owner * groups + group], for at least `owners` owners.
  std::vector<ErrorSums> finish(std::size_t owners, int rounds = 200);

 private:
  struct Mixed {
    std::size_t group, first, count;
    ErrorSums bin;
  };
  ErrorSums& sums_of(std::size_t owner, std::size_t group);
  std::size_t groups_;
  std::vector<ErrorSums> sums_;  // sums over bins that need no split
  std::vector<Mixed> mixed_;
  std::vector<OwnerShare> shares_;
};

}  // namespace tubefoot
