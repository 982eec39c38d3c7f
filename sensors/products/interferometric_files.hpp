// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sensors/products/products.hpp"

namespace tubefoot {

/// Writes what an interferometric sidescan makes beside a sidescan's pictures: <name>-phase.png and .exr,
/// <name>-coherence.exr, <name>-soundings.csv. Returns the files' names. Throws std::runtime_error naming the
/// file.
std::vector<std::filesystem::path> write_interferometric_files(const std::filesystem::path& folder,
                                                               const Recording& recording,
                                                               const RunContext& run);

}  // namespace tubefoot
