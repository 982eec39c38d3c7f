// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "import/frames/foreign_frame.hpp"

namespace tubefoot {

/// A matrix of numbers between commas, semicolons, tabs or blanks: a row of the picture a line. Lines that
/// begin with # are comments; where one says "First column is range", as DAVE's do, it is. Complex numbers
/// ("1.5-2.5i") count by their magnitudes. Throws InputError with line and column.
ForeignData read_matrix(const std::filesystem::path& file);

}  // namespace tubefoot
