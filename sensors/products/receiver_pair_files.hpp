// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sensors/products/received.hpp"

namespace tubefoot {

/// Writes the files of a receiver pair, in addition to the pictures of either side, and returns their names.
/// They are <name>-phase.png and .exr, <name>-coherence.exr and <name>-soundings.csv. Throws
/// std::runtime_error with the file's name.
std::vector<std::filesystem::path> write_receiver_pair_files(const std::filesystem::path& folder,
                                                             const Recording& recording,
                                                             const RunContext& run, bool phase_noise);

/// Names of these products (SensorKind::products()).
std::vector<std::string> receiver_pair_products();

}  // namespace tubefoot
