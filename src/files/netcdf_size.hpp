// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "files/input_error.hpp"

namespace tubefoot {

/// The smallest size in bytes that a netCDF classic file (CDF-1, 2 or 5) must have to hold the variables that
/// its header describes; nothing for any other file. A header that is itself cut off or nonsense gives 2^64
/// - 1. Needed because the netCDF library (4.9.0, tried) reads zeros past the end of a classic file that is
/// cut off, without an error: half a seabed would become a plain at height 0.
std::optional<std::uint64_t> netcdf_classic_size(const std::filesystem::path& file);

/// Throws InputError for a netCDF classic file that is smaller than that. Before the netCDF library sees the
/// file: it (4.9.0, tried) takes the sizes in a header at their word, gigabytes for an attribute of a small
/// file.
void refuse_short_netcdf(const SourcePlace& place);

}  // namespace tubefoot
