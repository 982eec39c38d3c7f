// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>

#include "files/input_error.hpp"

namespace tubefoot {

/// Returns the number of bytes that this process can still allocate. It is the minimum of the memory of the
/// machine, the limit of `ulimit -v` and the limits of the control groups (containers, batch systems).
/// Memory of other processes does not count, because it varies.
double memory_at_hand();

/// Throws std::bad_alloc if the address space lacks `bytes`. Call it before a library that would end the
/// program in this case.
void require_addresses(std::size_t bytes);

/// Bytes per facet, from reading until the scene is loaded with its tree, measured on flat terrain.
inline constexpr double bytes_a_facet = 80;

/// Checks an allocation whose size the input determines. Throws InputError at `place` if `bytes` exceed
/// memory_at_hand(): "`what` need 12.3 GB of memory, 1.2 GB are at hand: `remedy`".
void require_memory(double bytes, const SourcePlace& place, const std::string& what,
                    const std::string& remedy);

}  // namespace tubefoot
