// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/integrals/node_count.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace tubefoot {
namespace {

constexpr std::array<double, 19> rhos{1.3, 1.6, 2,  2.5, 3.2, 4,   5,   6.5, 8,   10,
                                      14,  20,  30, 50,  70,  100, 200, 500, 1000};

}  // namespace

NodeCount::NodeCount(const std::function<double(double y)>& growth, double tolerance) {
  for (int i = 0; i < extents; ++i) {
    const double extent = std::exp2(0.5 * (finest + i));
    int best = most_gauss_nodes + 1;
    std::size_t ellipse = 0;
    for (const double rho : rhos) {
      const double g = growth(extent * (rho - 1 / rho) / 2);
      const double excess = g < 600 ? std::expm1(g) * (64.0 / 15) / tolerance : 0;
      if (g < 600)
        best = std::min(
            best, excess <= 1 ? 1 : int(std::ceil(std::min(std::log(excess) / (2 * std::log(rho)), 99.0))));
      if (rho == ellipses[ellipse]) nodes_[ellipse++][i] = std::uint8_t(best);
    }
  }
}

int NodeCount::nodes(double extent, double rho) const {
  if (!(rho >= ellipses.front())) return most_gauss_nodes + 1;
  std::size_t ellipse = 0;
  while (ellipse + 1 < ellipses.size() && rho >= ellipses[ellipse + 1]) ++ellipse;
  // Index of the next larger extent in the table. The exponent of the square counts factors of 2^(1/2).
  const int exponent = int(std::bit_cast<std::uint64_t>(extent * extent) >> 52 & 0x7ff) - 1023;
  const int i = std::max(exponent + 1 - finest, 0);
  return i < extents ? nodes_[ellipse][std::size_t(i)] : most_gauss_nodes + 1;
}

}  // namespace tubefoot
