// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

namespace tubefoot {

/// How often memory was asked for by operator new since the program began, by all threads. Linking
/// allocations.cpp replaces every operator new and delete of the program; GMP's numbers go by malloc and are
/// not counted.
std::uint64_t allocations();

}  // namespace tubefoot
