// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

#include "engine/rays/ray_lanes.hpp"

namespace tubefoot {

/// Points of the two-dimensional Sobol' sequence (I. M. Sobol', USSR Comp. Math. Math. Phys. 7, 1967), its
/// digits scrambled by random triangular matrices and shifted (J. Matousek, J. Complexity 14, 1998). Every
/// point by itself is uniform, and every pair has the joint distribution that Owen's nested scrambling gives
/// it, so estimates are unbiased and have the variance of Owen's (A. B. Owen, ACM TOMACS 13, 2003).
///
/// Of the sequence's points [k 2^m, (k + 1) 2^m), which are a net: every grid of 2^a x 2^b cells with
/// a + b = m has one in each cell. They are walked by blocks of neighbouring cells of one such grid: as all
/// is linear in binary digits, number t is the exclusive or of what belongs to the bits of t.
class RayNet {
 public:
  /// So many of a sequence are resolved; who needs more takes another `key` for the next.
  static constexpr int most_bits = 30;

  RayNet() = default;
  /// The 2^m points from number `first`, a multiple of 2^m, on; 2^`column_bits` x 2^`row_bits` cells.
  RayNet(std::uint64_t key, std::uint32_t first, int column_bits, int row_bits);

  /// Sixteen points from t, a multiple of 16, on (fewer, if there are fewer), in a block of cells.
  NetBlock block(std::uint32_t t) const;

 private:
  std::array<std::uint32_t, most_bits> x_of_bit_{}, y_of_bit_{};  // by the bits of t
  std::uint32_t x_ = 0, y_ = 0;                                   // of t = 0
  NetBlock first_;
  int bits_ = 0;
};

}  // namespace tubefoot
