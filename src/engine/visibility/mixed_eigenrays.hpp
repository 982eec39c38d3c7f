// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "engine/visibility/bistatic_history.hpp"

namespace tubefoot {

/// What goes out along one ray and comes home along another, of the several that lead to a part of the seabed
/// (EigenrayBranches): two images of the part, as a transmitter and a separate receiver have them, but that
/// both are seen from one apex, on the mesh in which all sheets hide one another. `take` is called with each
/// pair of ranks of rays that share something, in both senses. Shared facets are numbered by part
/// (ApparentSurface::part_material). Adds up nothing where every part is seen by one ray.
///
/// Of two sheets one of which is turned over, the home one is looked at in a mirror: so both turn alike, and
/// what both see of one side of the seabed can be intersected, exactly as ever.
void trace_mixed_eigenrays(const ApparentSurface& surface_mesh, const SceneTree& tree, const WorldGrid& grid,
                           const VisibilityOptions& options, const TubeSet& tubes,
                           const std::function<void(const BistaticHistory&)>& take);

}  // namespace tubefoot
