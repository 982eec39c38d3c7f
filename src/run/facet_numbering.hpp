// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "scene/tiled_scene.hpp"

namespace tubefoot {

struct Site;

/// What facets are called where terrain is read by tiles: by the numbers that they have where all of the
/// scene is in memory, component by component, row by row of a raster (docs/big-terrain.md).
class FacetNumbering {
 public:
  /// Of a tiled site, which outlives this. Tiles that a material map or the sea surface may cut are read, to
  /// count what they leave. Throws InputError where one cannot be read, and for more facets than have
  /// numbers.
  explicit FacetNumbering(const Site& site);

  /// By facet of a site that has these tiles.
  std::vector<FacetId> of(const TileChoice& choice) const;
  /// Of the first facet of a row of tiles; of components that are not tiled, 0 is the first and only row. One
  /// row further on it is where the next component begins.
  FacetId first_of(std::size_t component, std::size_t row) const;
  std::size_t facets() const { return first_.back(); }

 private:
  /// Facets of a component's raster, of each of which the cuts leave so many, where that is not one.
  struct Run {
    std::uint64_t first, end, pieces;
    std::uint64_t before;  ///< left of those before the first
  };
  /// Of facets of a component's raster: in how many pieces one is left, and all those before it.
  struct Left {
    std::uint64_t pieces, before;
  };
  void count(std::size_t component, bool cut_by_surface);
  /// In how many pieces facets of some tiles are left: by facet.
  std::vector<std::uint64_t> pieces_of(std::size_t component, std::span<const std::uint32_t> tiles,
                                       bool cut_by_surface) const;
  Left left(std::size_t component, std::uint64_t number) const;

  const Scene& scene_;
  std::vector<std::vector<Run>> runs_;  ///< by component
  std::vector<FacetId> first_;          ///< by component, and of all
};

}  // namespace tubefoot
