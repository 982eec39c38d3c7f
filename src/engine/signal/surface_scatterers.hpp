// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "engine/signal/smooth_pieces.hpp"

namespace tubefoot {

/// Of a rule along an axis of a piece.
constexpr int most_rule_nodes = 8;

/// A point that stands for a piece of the seabed.
struct SurfaceScatterer {
  glm::dvec3 place_m{0};  ///< relative to the patches' origin
  double weight_m2 = 0;
  std::uint32_t patch = 0;
};

/// Nodes of Gauss rules over the patches: sums over them are integrals of products of two channels, relative
/// to what they would be without interference to about `tolerance`. Their weights are areas, above 0.
/// Law Y2 (moments): their weights add up to the patches' areas.
/// Law Y3 (covariance): sum of weight sigma h_a h_b* over them is R_ab, and so Hermitian and positive
/// semi-definite whatever their number.
std::vector<SurfaceScatterer> seabed_scatterers(const VisiblePolygons& seen, const SignalExtent& extent,
                                                double tolerance);

/// Error of Gauss-Legendre's rule of n nodes for the mean of e^{i change x} over -1 .. 1, at most.
double gauss_error(int nodes, double change_rad);

}  // namespace tubefoot
