// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>
#include <vector>

#include "import/frames/number_array.hpp"

// NumPy's files. https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html
namespace tubefoot {

/// An NPY file's bytes: real, whole or complex numbers (of which the magnitude is taken), in either order of
/// bytes and axes. Throws InputError at `place`, also for what is cut off, too long, or holds Python's own
/// objects, which would have to be run to be read.
NumberArray read_npy(std::string_view bytes, const SourcePlace& place);

/// All NPY files in an NPZ archive, by their names there, without ".npy".
std::vector<NumberArray> read_npz(std::string_view bytes, const SourcePlace& place);

}  // namespace tubefoot
