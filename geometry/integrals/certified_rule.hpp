// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "geometry/numbers/ball.hpp"
#include "geometry/numbers/interval.hpp"

namespace tubefoot {

/// The Gauss-Legendre rule of n nodes on [-1, 1], nodes and weights enclosed.
struct CertifiedRule {
  std::vector<Ball> node, weight;
  std::vector<Interval> node_in_doubles, weight_in_doubles;
};

constexpr int fewest_certified_nodes = 2, most_certified_nodes = 32;

/// For fewest_certified_nodes to most_certified_nodes.
const CertifiedRule& certified_rule(int nodes);

/// Upper bound of the rule's error on [-1, 1] over M, the integrand's bound in the ellipse of parameter rho,
/// in logarithms; doubles with a margin far beyond their rounding.
double log_error(double rho, int nodes);

/// Nodes that bring the error, M times it, below `allowed`; more than most_certified_nodes if there are none.
int nodes_for(double rho, double log_m, double allowed);

/// A rectangle around the ellipse of parameter rho about the interval [middle - half, middle + half].
ComplexBall around(const Ball& middle, const Ball& half, double rho);

/// The ellipse to try first about [along - half, along + half], for a singularity at i `across`. The
/// rectangle around it must keep away from the singularity and its square from the negative axis; one larger
/// than 64 saves no node.
double largest_rho(double along, double across, double half);

}  // namespace tubefoot
