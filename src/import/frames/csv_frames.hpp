// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "import/frames/foreign_frame.hpp"

namespace tubefoot {

/// Reads a matrix of numbers between commas, semicolons, tabs or blanks. A line is a row of the picture;
/// lines that begin with # are comments. If a comment contains "First column is range", as in files of
/// DAVE, the first column is the range. Complex numbers ("1.5-2.5i") count by their magnitudes. Throws
/// InputError with line and column.
ForeignData read_matrix(const std::filesystem::path& file);

}  // namespace tubefoot
