// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CGAL/Exact_rational.h>

#include <array>

#include "geometry/numbers/vector_products.hpp"
#include "geometry/numbers/world_grid.hpp"

// Vectors of rationals, for the reference arithmetic, the closure audit and the topology hash. This header is
// expensive to compile: include it only in .cpp files.
namespace tubefoot {

using ExactVector = std::array<CGAL::Exact_rational, 3>;

inline ExactVector exact(GridPoint p) { return {p.x, p.y, p.z}; }

inline ExactVector difference(const ExactVector& a, const ExactVector& b) {
  return {CGAL::Exact_rational(a[0] - b[0]), CGAL::Exact_rational(a[1] - b[1]),
          CGAL::Exact_rational(a[2] - b[2])};
}

}  // namespace tubefoot
