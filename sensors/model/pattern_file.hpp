// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "engine/scattering/beam_pattern.hpp"
#include "files/input_error.hpp"

namespace tubefoot {

/// Reads a beam pattern: CSV with the header line angle_deg,level_db and rows of increasing angle; lines that
/// are empty or start with # are passed over. A table that starts at 0 holds for both sides. Throws
/// InputError with the place in the file.
PatternTable read_pattern_file(const std::filesystem::path& file);

}  // namespace tubefoot
