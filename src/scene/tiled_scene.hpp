// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "scene/scene.hpp"

namespace tubefoot {

/// For each component of a scene, the tiles to load in increasing order; empty for components in its mesh.
using TileChoice = std::vector<std::vector<std::uint32_t>>;

/// Returns a scene with some tiles of its tiled terrains in its mesh, and with an empty `tiled`. Facets and
/// vertices have the same order as in a mesh with all tiles. Throws InputError for a raster that can no
/// longer be read, and for more facets than fit in memory.
Scene with_tiles(const Scene& scene, const TileChoice& choice);

/// Returns all tiles of a scene's tiled terrains.
TileChoice all_tiles(const Scene& scene);

}  // namespace tubefoot
