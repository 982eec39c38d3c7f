// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace tubefoot {

/// A line of text as drawn by a font: the coverage of each pixel, relative to the start of the line.
struct TextMask {
  int length = 0;  ///< width of the line in pixels, 0 for blanks only
  /// Position of the first pixel: to the right of the line's start, and down from its baseline.
  int left = 0, top = 0;
  int width = 0, height = 0;
  std::vector<unsigned char> coverage;  ///< in units of 1/255, row by row; without empty margins
};

/// Mask of `line` in printable ASCII, `size` pixels high, in a font that OpenImageIO finds. Each thread
/// caches its latest lines, because consecutive pictures share their labels. Throws std::runtime_error if
/// the font is not usable.
const TextMask& text_mask(const std::string& line, int size, const std::string& font);

}  // namespace tubefoot
