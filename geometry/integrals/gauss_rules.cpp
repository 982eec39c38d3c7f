// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/integrals/gauss_rules.hpp"

#include <algorithm>
#include <array>
#include <boost/math/special_functions/legendre.hpp>

namespace tubefoot {
namespace {

GaussRule make_rule(int nodes) {
  GaussRule rule;
  for (const double x : boost::math::legendre_p_zeros<double>(nodes)) {  // the function returns the nodes
                                                                         // that are not negative
    rule.node.push_back(x);
    if (x != 0) rule.node.push_back(-x);
  }
  std::sort(rule.node.begin(), rule.node.end());
  for (const double x : rule.node) {
    const double slope = boost::math::legendre_p_prime(nodes, x);
    rule.weight.push_back(2 / ((1 - x * x) * slope * slope));
  }
  return rule;
}

}  // namespace

const GaussRule& gauss_rule(int nodes) {
  static const std::array<GaussRule, most_gauss_nodes> rules = [] {
    std::array<GaussRule, most_gauss_nodes> all;
    for (int n = 1; n <= most_gauss_nodes; ++n) all[n - 1] = make_rule(n);
    return all;
  }();
  return rules.at(nodes - 1);
}

}  // namespace tubefoot
