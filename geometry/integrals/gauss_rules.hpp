// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

namespace tubefoot {

/// The Gauss-Legendre rule of n nodes on [-1, 1], in ascending order.
struct GaussRule {
  std::vector<double> node, weight;
};

constexpr int most_gauss_nodes = 24;

/// Requires `nodes` between 1 and most_gauss_nodes.
const GaussRule& gauss_rule(int nodes);

}  // namespace tubefoot
