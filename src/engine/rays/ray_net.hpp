// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

#include "engine/rays/ray_lanes.hpp"

namespace tubefoot {

/// Points of the two-dimensional Sobol' sequence (I. M. Sobol', USSR Comp. Math. Math. Phys. 7, 1967). Its
/// digits are scrambled by random triangular matrices and shifted (J. Matousek, J. Complexity 14, 1998).
/// Every single point is uniform. Every pair has the joint distribution of Owen's nested scrambling, so
/// estimates are unbiased and have the variance of Owen's (A. B. Owen, ACM TOMACS 13, 2003).
///
/// The class provides the points [k 2^m, (k + 1) 2^m) of the sequence, which are a net. Every grid of 2^a x
/// 2^b cells with a + b = m has one point in each cell. The points are enumerated by blocks of neighbouring
/// cells of one such grid. Since everything is linear in binary digits, point t is the exclusive or of the
/// words that belong to the bits of t.
class RayNet {
 public:
  /// Number of bits that a sequence resolves. For more points, use another `key`.
  static constexpr int most_bits = 30;

  RayNet() = default;
  /// Constructs the 2^m points from number `first` on, a multiple of 2^m, in 2^`column_bits` x 2^`row_bits`
  /// cells.
  RayNet(std::uint64_t key, std::uint32_t first, int column_bits, int row_bits);

  /// Returns sixteen points from t on, a multiple of 16, in a block of cells (fewer if fewer remain).
  NetBlock block(std::uint32_t t) const;

 private:
  std::array<std::uint32_t, most_bits> x_of_bit_{}, y_of_bit_{};  // per bit of t
  std::uint32_t x_ = 0, y_ = 0;                                   // for t = 0
  NetBlock first_;
  int bits_ = 0;
};

}  // namespace tubefoot
