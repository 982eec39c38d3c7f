// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "import/frames/number_array.hpp"

namespace tubefoot {

/// Pictures of a netCDF file's root group, whatever its variables are called; packed ones (scale_factor,
/// add_offset) are unpacked. Throws InputError.
ForeignData read_netcdf_frames(const std::filesystem::path& file, const WantedArrays& wanted);

}  // namespace tubefoot
