// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "run/tiles_in_view.hpp"

namespace tubefoot {

/// Pings one after the other that share the tiles they need, so that these are loaded once for all of them.
class RegionPlan {
 public:
  /// No region has more facets in its tiles than `most_facets`, unless one ping alone needs them.
  RegionPlan(const Transmissions& transmissions, std::uint64_t most_facets);

  struct Region {
    std::size_t group, first_ping;
    TileChoice tiles;
  };
  const std::vector<Region>& regions() const { return regions_; }
  /// The region of a ping.
  std::size_t of(std::size_t group, std::size_t ping) const;

 private:
  std::vector<Region> regions_;  ///< by group and ping
};

}  // namespace tubefoot
