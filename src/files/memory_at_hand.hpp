// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "files/input_error.hpp"

namespace tubefoot {

/// Bytes that this process can still take: what the machine has, what `ulimit -v` leaves and what its control
/// groups (containers, batch systems) leave, whichever is least. What other processes have taken is not
/// counted: they come and go.
double memory_at_hand();

/// Of a facet, from reading it until its scene is loaded and has its tree: measured on flat terrain.
inline constexpr double bytes_a_facet = 80;

/// To be asked before memory is taken whose amount the input decides. Throws InputError at `place` if `bytes`
/// are more than memory_at_hand(): "`what` need 12.3 GB of memory, 1.2 GB are at hand: `remedy`".
void require_memory(double bytes, const SourcePlace& place, const std::string& what,
                    const std::string& remedy);

}  // namespace tubefoot
