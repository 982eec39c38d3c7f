// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "geometry/numbers/ball.hpp"
#include "geometry/numbers/interval.hpp"

namespace tubefoot {

/// The Gauss-Legendre rule of n nodes on [-1, 1], with enclosed nodes and weights.
struct CertifiedRule {
  std::vector<Ball> node, weight;
  std::vector<Interval> node_in_doubles, weight_in_doubles;
};

constexpr int fewest_certified_nodes = 2, most_certified_nodes = 32;

/// Requires `nodes` between fewest_certified_nodes and most_certified_nodes.
const CertifiedRule& certified_rule(int nodes);

/// Logarithm of an upper bound of error / M on [-1, 1], where M bounds the integrand in the ellipse of
/// parameter rho. The result is a double with a margin far above its rounding.
double log_error(double rho, int nodes);

/// Number of nodes for which the error times M is below `allowed`. The result exceeds most_certified_nodes
/// if no rule suffices.
int nodes_for(double rho, double log_m, double allowed);

/// A rectangle around the ellipse of parameter rho about the interval [middle - half, middle + half].
ComplexBall around(const Ball& middle, const Ball& half, double rho);

/// Parameter of the ellipse to try first about [along - half, along + half], for a singularity at i
/// `across`. The rectangle around the ellipse must not contain the singularity, and its square must not meet
/// the negative axis. A parameter above 64 saves no node.
double largest_rho(double along, double across, double half);

}  // namespace tubefoot
