// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/arithmetic/exact_corner.hpp"
#include "geometry/arithmetic/wide_vector.hpp"

// Heavy, as wide_int.hpp.
namespace tubefoot {

/// Normal of a plane, exactly.
WideVec wide_normal(const NameContext& context, const PlaneName& plane);

/// Direction of a corner's ray, exactly.
/// Law E2 (names): up to a positive factor it is the direction that the names stand for (names.hpp).
WideVec wide_direction(const NameContext& context, const CornerName& corner);

}  // namespace tubefoot
