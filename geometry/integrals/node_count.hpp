// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>

#include "geometry/integrals/gauss_rules.hpp"

namespace tubefoot {

/// How many Gauss-Legendre nodes a beam pattern needs over a stretch of directions, tabulated once, as asking
/// is done for every arc of every footprint.
///
/// The rule's error is at most 64/15 M rho^-2n for what is at most M in the ellipse of parameter rho; a
/// pattern less its own value there is at most e^growth - 1.
class NodeCount {
 public:
  /// `growth(y)`: log of how large the pattern may get y into the imaginary, of directions or of cosines.
  /// `tolerance`: of the error, relative to the pattern's peak.
  NodeCount(const std::function<double(double y)>& growth, double tolerance);

  /// For a path that reaches `extent` to either side, as a function analytic within the ellipse `rho`; more
  /// than most_gauss_nodes if no rule is enough.
  int nodes(double extent, double rho) const;

 private:
  static constexpr int finest = -40, extents = 84;  // by factors of 2^(1/2), the first is 2^(finest / 2)
  static constexpr std::array<double, 5> ellipses{2, 4, 10, 100, 1000};
  std::array<std::array<std::uint8_t, extents>, ellipses.size()> nodes_{};
};

}  // namespace tubefoot
