// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sensors/products/received.hpp"

namespace tubefoot {

/// Writes what two receivers on a receiver pair make beside the pictures of either side: <name>-phase.png and
/// .exr, <name>-coherence.exr, <name>-soundings.csv. Returns the files' names. Throws std::runtime_error
/// naming the file.
std::vector<std::filesystem::path> write_receiver_pair_files(const std::filesystem::path& folder,
                                                             const Recording& recording,
                                                             const RunContext& run, bool phase_noise);

}  // namespace tubefoot
