// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "geometry/arithmetic/exact_corner.hpp"
#include "geometry/integrals/polar_slabs.hpp"
#include "geometry/numbers/fine_interval.hpp"
#include "geometry/visibility/visibility.hpp"

namespace tubefoot {

/// A visible piece in its facet's plane as CertifiedPolygon has it, in intervals of long doubles in place of
/// balls: much faster, to some 1e-18 of the range. Metres.
struct IntervalPolygon {
  struct Point {
    FineInterval x, y;
  };
  struct Edge {
    Interval angle;         ///< of its direction in the plane, up to whole turns
    Interval height;        ///< of the foot point to the edge's left
    FineInterval nearest2;  ///< squared range of its line's nearest point
  };
  FineInterval distance;  ///< of the apex from the plane
  std::vector<Point> points;
  std::vector<Edge> edges;
  FineInterval perimeter;
  std::vector<EdgeRanges> ranges;      ///< by edge
  std::optional<RangeEnclosure> foot;  ///< see PolarSlabs::cut
  bool foot_inside = false;
};

/// Encloses a piece. False if two neighbouring corners cannot be resolved: that takes balls. `unit_m` is a
/// power of two. `polygon` is written over, so that its lists are used again.
bool enclose_in_intervals(const NameContext& context, const std::vector<CornerName>& corners,
                          const NamedPiece& piece, double unit_m, IntervalPolygon& polygon);

/// Angle of a vector in a box, up to whole turns. Of one that is half a turn wide nothing is known.
Interval angle_of(const Interval& x, const Interval& y);

}  // namespace tubefoot
