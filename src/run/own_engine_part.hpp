// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "run/ping_sums.hpp"
#include "run/transmission.hpp"

namespace tubefoot {

/// Adds what an engine of one's own (own_engine.hpp) says that a transmission returns. Throws
/// std::domain_error where two receivers would have more in common than either receives.
void add_own_engine(const Transmission& transmission, PingSums& sums);

}  // namespace tubefoot
