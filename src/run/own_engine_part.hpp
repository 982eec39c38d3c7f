// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "run/contributions.hpp"

namespace tubefoot {

/// Adds the energies that an engine of the user (own_engine.hpp) computes for a transmission. Throws
/// std::domain_error if the cross product of two receivers exceeds the geometric mean of their energies.
void add_own_engine(const EchoContribution& plan, const Transmission& transmission, PingSums& sums);

}  // namespace tubefoot
