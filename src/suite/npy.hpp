// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <span>

namespace tubefoot {

/// Writes an array of float64 in C order in NumPy's format 1.0, little-endian. Throws write_error().
void write_npy(const std::filesystem::path& file, std::array<std::size_t, 3> shape,
               std::span<const double> values);

}  // namespace tubefoot
