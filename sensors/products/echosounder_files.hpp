// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sensors/products/products.hpp"

namespace tubefoot {

/// Writes what an echosounder makes: <name>.csv, the bottom that each ping detects; <name>.png, an echogram
/// of what is received; <name>.exr, the energies (pings x samples, unscaled). Returns the files' names.
/// Throws std::runtime_error naming the file.
std::vector<std::filesystem::path> write_echosounder_files(const std::filesystem::path& folder,
                                                           const Recording& recording, const RunContext& run,
                                                           std::vector<std::string>& warnings);

}  // namespace tubefoot
