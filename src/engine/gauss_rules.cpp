// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/gauss_rules.hpp"

#include <array>
#include <boost/math/special_functions/legendre.hpp>

namespace tubefoot {
namespace {

GaussRule make_rule(int nodes) {
  GaussRule rule;
  const auto add = [&](double x) {
    const double slope = boost::math::legendre_p_prime(nodes, x);
    rule.node.push_back(x);
    rule.weight.push_back(2 / ((1 - x * x) * slope * slope));
  };
  for (const double x : boost::math::legendre_p_zeros<double>(nodes)) {  // those that are not negative
    add(x);
    if (x != 0) add(-x);
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
