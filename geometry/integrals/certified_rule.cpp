// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/integrals/certified_rule.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace tubefoot {
namespace {

double ellipse_through(double along, double across, double half) {
  const double a = std::hypot((along - half) / half, across / half);
  const double b = std::hypot((along + half) / half, across / half);
  const double sum = (a + b) / 2;
  return sum + std::sqrt(std::max(sum * sum - 1, 0.0));
}

}  // namespace

const CertifiedRule& certified_rule(int nodes) {
  static const std::array<CertifiedRule, most_certified_nodes + 1> rules = [] {
    std::array<CertifiedRule, most_certified_nodes + 1> all;
    for (int n = fewest_certified_nodes; n <= most_certified_nodes; ++n)
      for (int k = 0; k < n; ++k) {
        Ball node, weight;
        arb_hypgeom_legendre_p_ui_root(node.get(), weight.get(), ulong(n), ulong(k), ball_bits + 32);
        all[n].node.push_back(node);
        all[n].weight.push_back(weight);
        all[n].node_in_doubles.emplace_back(node.lo(), node.hi());
        all[n].weight_in_doubles.emplace_back(weight.lo(), weight.hi());
      }
    return all;
  }();
  return rules[nodes];
}

double log_error(double rho, int nodes) {
  return std::log(64.0 / 15) - 2 * nodes * std::log(rho) - std::log1p(-1 / (rho * rho)) + 1e-9;
}

int nodes_for(double rho, double log_m, double allowed) {
  if (!(allowed > 0)) return most_certified_nodes + 1;
  const double excess = log_m - std::log(allowed) + log_error(rho, 0);
  const double n = std::ceil(excess / (2 * std::log(rho)));
  return n > most_certified_nodes ? most_certified_nodes + 1 : std::max(fewest_certified_nodes, int(n));
}

ComplexBall around(const Ball& middle, const Ball& half, double rho) {
  const Ball a = half * Ball((rho + 1 / rho) / 2 * (1 + 1e-12)),
             b = half * Ball((rho - 1 / rho) / 2 * (1 + 1e-12));
  return {middle + a * Ball::between(-1, 1), b * Ball::between(-1, 1)};
}

double largest_rho(double along, double across, double half) {
  return std::min(1 + 0.4 * (ellipse_through(along, across, half) - 1), 64.0);
}

}  // namespace tubefoot
