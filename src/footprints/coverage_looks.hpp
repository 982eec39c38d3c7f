// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/footprints/coverage.hpp"
#include "run/transmission.hpp"

namespace tubefoot {

/// Returns the visible parts of the facets of the scene in one transmission of a sensor, for a coverage.
/// With a separate receiver, visibility is common to both ends. The surfaces are those of the transmission
/// where it has its own.
/// Paths that are scattered once over mirrors add one CoverageLook per pair of images and direction.
/// `only_order` of [paths] selects the orders. `ping` is the number of the ping in the coverage. Throws
/// InputError under the same conditions as a run.
std::vector<CoverageLook> coverage_looks(const Transmission& transmission, std::size_t sensor,
                                         std::uint32_t ping);

}  // namespace tubefoot
