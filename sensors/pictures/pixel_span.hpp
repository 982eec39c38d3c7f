// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>

namespace tubefoot {

/// The items [first, end) of `count` under pixel `pixel` of `pixels`. If there are more items than pixels,
/// the pixels divide the items in order. Otherwise the result is the one item that the pixel shows.
struct PixelSpan {
  std::size_t first = 0, end = 0;
};

inline PixelSpan items_under(int pixel, int pixels, std::size_t count) {
  const auto place = [&](int p) {
    return static_cast<std::size_t>(p) * count / static_cast<std::size_t>(pixels);
  };
  const std::size_t first = place(pixel);
  return {first, std::max(place(pixel + 1), first + 1)};
}

}  // namespace tubefoot
