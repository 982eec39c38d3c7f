// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "scene/scene.hpp"

namespace tubefoot {

/// Of each component of a scene, the tiles to load, by increasing number; nothing for components that are in
/// its mesh.
using TileChoice = std::vector<std::vector<std::uint32_t>>;

/// A scene with tiled terrains, with some of their tiles in its mesh: facets and vertices in the order that
/// the mesh would have with all of them. Its `tiled` is empty. Throws InputError for a raster that can no
/// longer be read, and for more facets than there is memory for.
Scene with_tiles(const Scene& scene, const TileChoice& choice);

/// All tiles of a scene's tiled terrains.
TileChoice all_tiles(const Scene& scene);

}  // namespace tubefoot
