// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "geometry/arithmetic/exact_corner.hpp"
#include "geometry/integrals/polar_polygon.hpp"
#include "geometry/numbers/fine_interval.hpp"
#include "geometry/visibility/visibility.hpp"

namespace tubefoot {

/// The same data as CertifiedPolygon, in intervals of long doubles instead of balls. The computation is much
/// faster, and accurate to some 1e-18 of the range.
using IntervalPolygon = PolarPolygon<FineInterval, Interval>;

/// Encloses a visible polygon. Returns false if two neighbouring corners cannot be resolved; such a polygon
/// needs ball arithmetic. `unit_m` is a power of two. The function overwrites `polygon` and reuses its
/// memory.
bool enclose_in_intervals(const NameContext& context, const std::vector<CornerName>& corners,
                          const NamedPiece& piece, double unit_m, IntervalPolygon& polygon);

/// Angle of a vector in a box, up to whole turns. The result is unbounded for a box that spans half a turn.
Interval angle_of(const Interval& x, const Interval& y);

}  // namespace tubefoot
