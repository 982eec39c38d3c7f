// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

namespace tubefoot {

/// A picture in square pixels, row by row; not a number where nothing was seen.
struct PixelMap {
  std::size_t columns = 0, rows = 0;
  std::vector<double> values;

  double at(std::size_t column, std::size_t row) const { return values[row * columns + column]; }
};

/// How far the content of one picture lies from where it was in another.
struct FrameShift {
  double columns = 0, rows = 0;  ///< to fractions of a pixel
  double correlation = 0;        ///< normalised, at the best whole shift: 1 for the same content
};

/// Finds the shift (c, r) for which second(x + c, y + r) is most like first(x, y): the largest normalised
/// cross-correlation over the pixels that both have seen, among whole shifts of at most `most_shift` pixels
/// either way, then the vertex of a parabola through the peak and its neighbours. Shifts with an overlap of
/// less than a quarter of the first picture's pixels are not considered. Throws std::invalid_argument for
/// pictures of different sizes, without content, or smaller than the shift.
FrameShift find_shift(const PixelMap& first, const PixelMap& second, int most_shift);

}  // namespace tubefoot
