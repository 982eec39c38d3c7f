// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>
#include <vector>

namespace tubefoot {

/// An RGB picture as a PNG file (ISO/IEC 15948): `components` are red, green and blue of each pixel, 0 to 1,
/// row by row from the top, and are rounded to `bits` of 8 or 16 each; `description` is its text of that
/// name, made harmless (shown()). The same bytes on any thread. Throws std::invalid_argument for a picture of
/// no size, of another number of components, or beyond what one chunk holds, and std::bad_alloc.
std::vector<unsigned char> png_bytes(int width, int height, std::span<const float> components, int bits,
                                     const std::string& description);

}  // namespace tubefoot
