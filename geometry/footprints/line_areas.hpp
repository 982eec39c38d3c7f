// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>

#include "geometry/arithmetic/long_integers.hpp"
#include "geometry/footprints/line_table.hpp"
#include "geometry/footprints/plane_lines.hpp"

// Areas of polygons of lines as rationals. This header is expensive to compile: include it only in .cpp
// files.
namespace tubefoot {

Integer integer(const HugeInt& x);

/// Returns twice the area of a polygon on its chart.
Fraction double_area(const LinePolygon& polygon);
Fraction double_area(const LineTable& table, std::span<const DirectedLine> polygon);
/// Returns the same modulo the prime of residues. In the rare case that it divides a denominator, the
/// fraction is computed first.
Residue double_area_residue(const LineTable& table, std::span<const DirectedLine> polygon);

/// A share as a double and as a reduced fraction, "p/q" (or "0", "1").
struct ExactShare {
  double share = 0;
  std::string exact;
};
ExactShare share_of(const Fraction& area, const Integer& whole);

}  // namespace tubefoot
