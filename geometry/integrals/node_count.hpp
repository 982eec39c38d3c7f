// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>

#include "geometry/integrals/gauss_rules.hpp"

namespace tubefoot {

/// Number of Gauss-Legendre nodes for the integral of a beam pattern over a range of directions. A table
/// serves the query, because every arc of every footprint makes one.
///
/// The rule's error is at most 64/15 M rho^-2n for a function bounded by M in the ellipse of parameter rho.
/// A pattern less its value at the centre is at most e^growth - 1 there.
class NodeCount {
 public:
  /// `growth(y)` is the logarithm of the pattern's bound at distance y into the imaginary, of directions or
  /// of cosines. `tolerance` is the error relative to the pattern's peak.
  NodeCount(const std::function<double(double y)>& growth, double tolerance);

  /// Number of nodes for a path that reaches `extent` to either side, as a function analytic within the
  /// ellipse `rho`. The result exceeds most_gauss_nodes if no rule suffices.
  int nodes(double extent, double rho) const;

 private:
  static constexpr int finest = -40, extents = 84;  // in factors of 2^(1/2), from 2^(finest / 2) on
  static constexpr std::array<double, 5> ellipses{2, 4, 10, 100, 1000};
  std::array<std::array<std::uint8_t, extents>, ellipses.size()> nodes_{};
};

}  // namespace tubefoot
