// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "import/frames/foreign_frame.hpp"

namespace tubefoot {

/// Returns the OpenImageIO name of the format of a PNG, TIFF or OpenEXR file from its first bytes, or an
/// empty string for other files.
std::string_view picture_format(std::string_view head);

/// Reads the numbers of a picture as stored (8 bits: 0 to 255), the top row first. Each page of a TIFF and
/// each part of an EXR is a frame. `channel` is the name of a channel; empty: the only one, or equal colour
/// channels. `bytes` is the whole file. Throws InputError.
ForeignData read_picture(const std::filesystem::path& file, std::string_view bytes,
                         const std::string& channel);

}  // namespace tubefoot
