// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>
#include <vector>

namespace tubefoot {

/// Encodes an RGB picture as a PNG file (ISO/IEC 15948). `components` are red, green and blue of each pixel,
/// 0 to 1, row by row from the top. The function rounds them to `bits` of 8 or 16 each. `description` is the
/// file's text chunk, with control characters escaped (shown()). The bytes are the same on any thread.
/// Throws std::invalid_argument for an empty picture, for another number of components, and for more data
/// than one chunk may contain. Throws std::bad_alloc.
std::vector<unsigned char> png_bytes(int width, int height, std::span<const float> components, int bits,
                                     const std::string& description);

}  // namespace tubefoot
