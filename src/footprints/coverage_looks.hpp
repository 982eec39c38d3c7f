// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/footprints/coverage.hpp"
#include "run/transmission.hpp"

namespace tubefoot {

/// What a transmission sees, as a sensor receives it, for a coverage of the scene's facets: from both ends
/// where the receiver is apart, and on the transmission's own ground where it has one; and what it sees over
/// mirrors, a look for each pair of images between which something is scattered once, on whichever way.
/// `only_order` of [paths] chooses. `ping`: as the coverage counts. Throws InputError as a run does.
std::vector<CoverageLook> coverage_looks(const Transmission& transmission, std::size_t sensor,
                                         std::uint32_t ping);

}  // namespace tubefoot
