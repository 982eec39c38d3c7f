// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "run/transmission.hpp"
#include "scene/tiled_scene.hpp"

namespace tubefoot {

/// One ping as one sensor receives it.
struct ReceivedPing {
  std::size_t sensor = 0, ping = 0;
};

/// Facets with consecutive numbers (LoadedScene::number_of), and all pings that may see them.
struct FacetBlock {
  FacetId first = 0, end = std::numeric_limits<FacetId>::max();
  std::vector<std::size_t> pings;  ///< indices into the list of pings that the caller passed
  TileChoice tiles;                ///< tiles that these pings need
};

/// Returns the facets that the pings may see, in blocks, for work that combines facets with the pings that
/// see them. The result is one block if all terrain is in memory. For terrain that is read by tiles, the
/// blocks have increasing facet numbers and fit into the tile cache. No block is smaller than a row of
/// tiles.
std::vector<FacetBlock> facet_blocks(const Transmissions& transmissions, std::span<const ReceivedPing> pings);

}  // namespace tubefoot
