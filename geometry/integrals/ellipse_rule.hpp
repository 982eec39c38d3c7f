// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/integrals/gauss_rules.hpp"

// Gauss-Legendre rules for functions that are analytic in an ellipse about [-1, 1].
namespace tubefoot {

/// Parameter of the largest ellipse about [-1, 1] that does not contain x + iy: the sum of its half axes.
inline double ellipse_through(double x, double y) {
  const double a = std::max(1.0, (std::hypot(x - 1, y) + std::hypot(x + 1, y)) / 2);
  return a + std::sqrt(a * a - 1);
}

/// Number of Gauss nodes for a function that is analytic in the ellipse `rho` and grows with e^{growth |Im|}
/// off [-1, 1]. The rule's error is at most 64/15 M rho^-2n. The function selects the best of some smaller
/// ellipses, for an error of e^-log_error 64/15. A result above most_gauss_nodes means that no rule
/// suffices.
inline int nodes_within(double rho, double growth, double log_error) {
  double fewest = std::numeric_limits<double>::infinity();
  for (const double ellipse : {1.5, 2.0, 3.0, 5.0, 9.0, 17.0, 40.0, 200.0}) {
    if (ellipse > 0.8 * rho) break;
    fewest = std::min(fewest, (log_error + growth * (ellipse - 1 / ellipse) / 2) / (2 * std::log(ellipse)));
  }
  return fewest < most_gauss_nodes ? static_cast<int>(std::ceil(fewest)) : most_gauss_nodes + 1;
}

}  // namespace tubefoot
