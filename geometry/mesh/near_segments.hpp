// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "geometry/mesh/plan_cut.hpp"

namespace tubefoot {

/// Calls visit(i, j), i < j, at least once for every pair of segments with a common point, and for few other
/// pairs. The segments are divided recursively along the direction that separates them best. Long parallel
/// segments and many segments in one place are therefore not compared one by one. Coordinates must be finite.
void for_each_near_pair(std::span<const PlanSegment> segments,
                        const std::function<void(std::uint32_t, std::uint32_t)>& visit);

}  // namespace tubefoot
