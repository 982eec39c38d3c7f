// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "run/tiles_in_view.hpp"

namespace tubefoot {

/// Regions of consecutive pings that share the tiles they need, so that these tiles are loaded once for all
/// of them.
class RegionPlan {
 public:
  /// No region has more than `most_facets` facets in its tiles, unless a single ping needs more.
  RegionPlan(const Transmissions& transmissions, std::uint64_t most_facets);

  struct Region {
    std::size_t group, first_ping;
    TileChoice tiles;
  };
  const std::vector<Region>& regions() const { return regions_; }
  /// Returns the region of a ping.
  std::size_t of(std::size_t group, std::size_t ping) const;

 private:
  std::vector<Region> regions_;  ///< by group and ping
};

}  // namespace tubefoot
