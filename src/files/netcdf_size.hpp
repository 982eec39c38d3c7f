// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "files/input_error.hpp"

namespace tubefoot {

/// Returns the minimum size in bytes of a netCDF classic file (CDF-1, 2 or 5) with the variables of its
/// header. It is empty for any other file. An incomplete or invalid header gives 2^64 - 1. The netCDF
/// library (4.9.0, tested) reads zeros past the end of a truncated classic file without an error. Half a
/// seabed would become a plain at height 0.
std::optional<std::uint64_t> netcdf_classic_size(const std::filesystem::path& file);

/// Throws InputError for a netCDF classic file that is smaller than netcdf_classic_size(). The check must
/// precede the netCDF library (4.9.0, tested), which trusts the sizes in a header. It would allocate
/// gigabytes for an attribute of a small file.
void refuse_short_netcdf(const SourcePlace& place);

}  // namespace tubefoot
