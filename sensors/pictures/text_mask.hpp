// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace tubefoot {

/// A line of text as a font draws it: how much of each pixel it covers, about the place where the line
/// begins.
struct TextMask {
  int length = 0;  ///< pixels that the line takes, 0 if it is of blanks alone
  /// Of the first pixel, from the line's beginning to the right and from its baseline down.
  int left = 0, top = 0;
  int width = 0, height = 0;
  std::vector<unsigned char> coverage;  ///< of 255, row by row; what is empty all round is left out
};

/// `line` in printable ASCII, `size` pixels high, by a font that OpenImageIO finds. The lines that a thread
/// asked for last are kept, since the labels of a picture are those of the one before it. Throws
/// std::runtime_error where the font cannot be drawn with.
const TextMask& text_mask(const std::string& line, int size, const std::string& font);

}  // namespace tubefoot
