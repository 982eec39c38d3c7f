// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <OpenImageIO/imageio.h>

#include <filesystem>
#include <string>
#include <vector>

namespace tubefoot {

/// For messages: what OpenImageIO says of what it cannot do. Where memory is short it says little or nothing.
std::string reason_in_words(const std::string& said);

/// The bytes of an image of float pixels, as `spec` and the ending of the file's name say; `file` itself is
/// not touched. Throws std::runtime_error naming it.
std::vector<unsigned char> encoded_image(const std::filesystem::path& file, const OIIO::ImageSpec& spec,
                                         const float* pixels);

/// Writes them. Throws std::runtime_error naming the file.
void write_image(const std::filesystem::path& file, const OIIO::ImageSpec& spec, const float* pixels);

/// How a one-channel float EXR is written: lossless, the same bytes at any time of day. `attributes` are
/// added to its header.
OIIO::ImageSpec exr_spec(const OIIO::ParamValueList& attributes);

/// Writes a one-channel float EXR with lossless compression: rows from the top, untouched values.
/// `attributes` are added to its header. Throws std::runtime_error naming the file.
void write_exr(const std::filesystem::path& file, int width, int height, const std::vector<float>& values,
               const OIIO::ParamValueList& attributes);

}  // namespace tubefoot
