// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

namespace tubefoot {

/// Draws an SVG into a PNG file, `scale` pixels for each of its own (librsvg, cairo). Throws
/// std::runtime_error naming the file where that fails.
void write_png_of_svg(const std::string& svg, const std::filesystem::path& file, double scale = 1.5);

}  // namespace tubefoot
