// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "engine/scattering/beam_pattern.hpp"
#include "files/input_error.hpp"

namespace tubefoot {

/// Reads a beam pattern: CSV with the header line angle_deg,level_db and rows of increasing angle. Empty
/// lines and lines that start with # are skipped. A table that starts at 0 applies to both sides. Throws
/// InputError with the position in the file.
PatternTable read_pattern_file(const std::filesystem::path& file);

}  // namespace tubefoot
