// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "import/frames/foreign_frame.hpp"

namespace tubefoot {

/// What OpenImageIO calls the format of a file that begins so, of a PNG, a TIFF or an OpenEXR file; else
/// empty.
std::string_view picture_format(std::string_view head);

/// A picture's numbers as they are stored (8 bits: 0 to 255), the top row first; each page of a TIFF, or part
/// of an EXR, is a frame. `channel`: that one by its name; empty: the only one, or colours that are all
/// alike. `bytes`: of the whole file. Throws InputError.
ForeignData read_picture(const std::filesystem::path& file, std::string_view bytes,
                         const std::string& channel);

}  // namespace tubefoot
