// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "import/frames/number_array.hpp"

namespace tubefoot {

/// Reads the pictures in the root group of a netCDF file, whatever the names of its variables are. Applies
/// scale_factor and add_offset. Throws InputError.
ForeignData read_netcdf_frames(const std::filesystem::path& file, const WantedArrays& wanted);

}  // namespace tubefoot
