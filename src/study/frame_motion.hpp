// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

namespace tubefoot {

/// A picture with square pixels, row by row; NaN where nothing is visible.
struct PixelMap {
  std::size_t columns = 0, rows = 0;
  std::vector<double> values;

  double at(std::size_t column, std::size_t row) const { return values[row * columns + column]; }
};

/// Displacement of the contents of one picture relative to another.
struct FrameShift {
  double columns = 0, rows = 0;  ///< in pixels, with fractions
  double correlation = 0;        ///< normalised, at the best integer shift: 1 for the same contents
};

/// Finds the shift (c, r) for which second(x + c, y + r) correlates best with first(x, y).
///
/// The function computes the normalised cross-correlation over the common pixels for all integer shifts of
/// at most `most_shift` pixels in each direction. The vertex of a parabola through the maximum and its
/// neighbours gives the fraction. Shifts with an overlap of less than a quarter of the pixels of the first
/// picture are excluded.
///
/// Throws std::invalid_argument for pictures of different sizes, without contents, or smaller than the
/// shift.
FrameShift find_shift(const PixelMap& first, const PixelMap& second, int most_shift);

}  // namespace tubefoot
