// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

namespace tubefoot {

/// Returns the number of allocations by operator new since the start of the program, over all threads.
/// Linking allocations.cpp replaces every operator new and delete of the program. GMP allocates numbers
/// with malloc; they are not counted.
std::uint64_t allocations();

}  // namespace tubefoot
