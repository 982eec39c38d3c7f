// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "engine/visibility/bistatic_history.hpp"

namespace tubefoot {

/// Computes mixed-eigenray returns. Several eigenrays lead to a part of the seabed (EigenrayBranches), and a
/// path leaves along one and returns along another. The two images of the part are treated as those of a
/// transmitter and a separate receiver. Both images are seen from one apex, in a mesh in which all eigenray
/// branches hide one another. `take` is called for each pair of ranks of rays with common parts, in both
/// orders. Shared facets are numbered by part (ApparentSurface::part_material). The function has no effect if
/// every part is seen along one ray only.
///
/// If one of two branches is reversed, the receive branch is mirrored. Both branches then have the same
/// orientation. The parts of one side of the seabed that both see can therefore be intersected exactly, with
/// the usual method.
void trace_mixed_eigenrays(const ApparentSurface& surface_mesh, const SceneTree& tree, const WorldGrid& grid,
                           const VisibilityOptions& options, const TubeSet& tubes,
                           const std::function<void(const BistaticHistory&)>& take);

}  // namespace tubefoot
