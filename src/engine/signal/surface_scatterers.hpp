// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "engine/signal/smooth_pieces.hpp"

namespace tubefoot {

/// Largest number of nodes of a rule along one axis of a piece.
constexpr int most_rule_nodes = 8;

/// Point that represents a piece of the seabed.
struct SurfaceScatterer {
  glm::dvec3 place_m{0};  ///< relative to the polygons' origin
  double weight_m2 = 0;
  std::uint32_t patch = 0;
};

/// Nodes of Gauss rules over the polygons. Sums over the nodes are integrals of products of two channels.
/// The error is about `tolerance`, relative to the integrals without interference. Weights are areas and
/// positive.
/// Law Y2 (moments): the sum of the weights is the area of the polygons.
/// Law Y3 (covariance): the sum of weight sigma h_a h_b* is R_ab. The matrix is therefore Hermitian and
/// positive semi-definite for any number of nodes.
std::vector<SurfaceScatterer> seabed_scatterers(const VisiblePolygons& seen, const SignalExtent& extent,
                                                double tolerance);

/// Bound of the error of the Gauss-Legendre rule with n nodes for the mean of e^{i change x} over -1 .. 1.
double gauss_error(int nodes, double change_rad);

}  // namespace tubefoot
