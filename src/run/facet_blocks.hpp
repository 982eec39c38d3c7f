// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "run/transmission.hpp"
#include "scene/tiled_scene.hpp"

namespace tubefoot {

/// A ping as a sensor receives it.
struct ReceivedPing {
  std::size_t sensor = 0, ping = 0;
};

/// Facets with numbers one after the other (Site::number_of), and all pings that may have to do with them.
struct FacetBlock {
  FacetId first = 0, end = std::numeric_limits<FacetId>::max();
  std::vector<std::size_t> pings;  ///< as they stand in the list that was asked for
  TileChoice tiles;                ///< what these pings need
};

/// The facets that pings may have to do with, for what looks at facets and at the pings that see them: one
/// block, or, where terrain is read by tiles, by increasing numbers as many as the cache for tiles asks for;
/// none holds less than a row of tiles.
std::vector<FacetBlock> facet_blocks(const Transmissions& transmissions, std::span<const ReceivedPing> pings);

}  // namespace tubefoot
