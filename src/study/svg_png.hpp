// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

namespace tubefoot {

/// Renders an SVG into a PNG file with `scale` pixels per SVG pixel (librsvg, cairo). Throws
/// std::runtime_error, which names the file, on failure.
void write_png_of_svg(const std::string& svg, const std::filesystem::path& file, double scale = 1.5);

}  // namespace tubefoot
