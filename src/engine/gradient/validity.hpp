// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "engine/gradient/echo_gradient.hpp"
#include "geometry/visibility/visibility.hpp"

namespace tubefoot {

/// Steps of one parameter without a change of combinatorics: the visible polygons of all parameters between
/// -backward and forward have the same names.
struct ValidSteps {
  double forward = 0, backward = 0;
  /// Whether the names are not certain at the parameter 0 itself. The pose then lies on a change of
  /// combinatorics, and derivatives may be one-sided. Both steps are 0.
  bool on_change = false;
};

/// Returns the smaller steps of both.
ValidSteps common_steps(const ValidSteps& a, const ValidSteps& b);

/// Computes proven lower bounds of the steps to the first change of the visible polygons of each tube:
/// [parameter][tube] (docs/notes/gradients.md, section 6). Steps are at most `largest` per parameter. Each
/// bound is within 2 % of the step at which the certificate fails. Points move along straight lines, and
/// turned points on circles. Parameters that move no point have infinite steps. `options`: as for the
/// history; the arithmetic must be exact. `wanted`: tubes whose steps are necessary; empty: all. Throws
/// std::invalid_argument for another arithmetic, and unless `largest` has one positive number per parameter.
std::vector<std::vector<ValidSteps>> valid_steps(const FacetMesh& mesh, const SceneTree& tree,
                                                 const TubeSet& tubes, double grid_unit_m,
                                                 const VisibilityOptions& options,
                                                 std::span<const EchoParameter> parameters,
                                                 std::span<const double> largest,
                                                 const std::vector<bool>& wanted = {});

}  // namespace tubefoot
