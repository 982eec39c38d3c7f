// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace tubefoot {

struct Scene;

/// Adds the warnings of a loaded scene to its report. They are about facets without echoes, facets above the
/// sea surface, a coarse grid, and layers of volume scattering that end above the seabed. Depths count from
/// `surface_height_m`.
void add_warnings(Scene& scene, double surface_height_m);

}  // namespace tubefoot
