// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "geometry/arithmetic/long_integers.hpp"
#include "geometry/footprints/plane_lines.hpp"

// Areas of polygons of lines as rationals. This header is expensive to compile: include it only in .cpp
// files.
namespace tubefoot {

Integer integer(const HugeInt& x);

/// Returns twice the area of a polygon on its chart.
Fraction double_area(const LinePolygon& polygon);

/// A share as a double and as a reduced fraction, "p/q" (or "0", "1").
struct ExactShare {
  double share = 0;
  std::string exact;
};
ExactShare share_of(const Fraction& area, const Integer& whole);

}  // namespace tubefoot
