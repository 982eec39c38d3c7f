// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/arithmetic/exact_corner.hpp"
#include "geometry/arithmetic/wide_vector.hpp"

// Expensive to compile, as wide_int.hpp is.
namespace tubefoot {

/// Returns the exact normal of a plane.
WideVec wide_normal(const NameContext& context, const PlaneName& plane);

/// Returns the exact direction of a corner's ray.
///
/// Law E2 (names): up to a positive factor it is the direction that the names define (names.hpp).
WideVec wide_direction(const NameContext& context, const CornerName& corner);

}  // namespace tubefoot
