// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "geometry/mesh/plan_cut.hpp"

namespace tubefoot {

/// Calls visit(i, j), i < j, at least once for every pair of segments that have a point in common, and for
/// few others. The segments are halved along the direction that separates them best, so that neither long
/// parallel segments nor many in one place are compared one by one. Coordinates are finite.
void for_each_near_pair(std::span<const PlanSegment> segments,
                        const std::function<void(std::uint32_t, std::uint32_t)>& visit);

}  // namespace tubefoot
