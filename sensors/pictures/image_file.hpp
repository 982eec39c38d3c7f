// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <OpenImageIO/imageio.h>

#include <filesystem>
#include <string>
#include <vector>

namespace tubefoot {

/// Text of an OpenImageIO error for messages. Without enough memory OpenImageIO reports little or nothing.
std::string reason_in_words(const std::string& said);

/// The bytes of an image of float pixels. `spec` and the extension of the file's name give the format; the
/// function does not write `file`. Throws std::runtime_error with the file's name.
std::vector<unsigned char> encoded_image(const std::filesystem::path& file, const OIIO::ImageSpec& spec,
                                         const float* pixels);

/// Writes these bytes. Throws std::runtime_error with the file's name.
void write_image(const std::filesystem::path& file, const OIIO::ImageSpec& spec, const float* pixels);

/// Format of a one-channel float EXR: lossless, with the same bytes at any time of day. Adds `attributes` to
/// its header.
OIIO::ImageSpec exr_spec(const OIIO::ParamValueList& attributes);

/// Writes a one-channel float EXR with lossless compression: rows from the top, unchanged values. Adds
/// `attributes` to its header. Throws std::runtime_error with the file's name.
void write_exr(const std::filesystem::path& file, int width, int height, const std::vector<float>& values,
               const OIIO::ParamValueList& attributes);

}  // namespace tubefoot
