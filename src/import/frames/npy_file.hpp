// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>
#include <vector>

#include "import/frames/number_array.hpp"

// Files of NumPy: https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html
namespace tubefoot {

/// Reads the bytes of an NPY file: real, integer or complex numbers (the latter as magnitudes), in either
/// order of bytes and axes. Throws InputError at `place`, also for data that is truncated or too long, and
/// for pickled Python objects. Reading the latter would execute code.
NumberArray read_npy(std::string_view bytes, const SourcePlace& place);

/// Reads all NPY files of an NPZ archive. Their names are those of the archive without ".npy".
std::vector<NumberArray> read_npz(std::string_view bytes, const SourcePlace& place);

}  // namespace tubefoot
