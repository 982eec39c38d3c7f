// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/footprints/coverage.hpp"
#include "run/shot.hpp"

namespace tubefoot {

/// What a shot sees, as a sensor hears it, for a coverage of the scene's facets: from both ends where the
/// receiver is apart, and on the shot's own ground where it has one. `ping`: as the coverage counts.
CoverageLook coverage_look(const Shot& shot, std::size_t sensor, std::uint32_t ping);

}  // namespace tubefoot
