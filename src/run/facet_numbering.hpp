// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "scene/tiled_scene.hpp"

namespace tubefoot {

struct LoadedScene;

/// Things in a row, each of which is left in some number of pieces.
class PieceCount {
 public:
  /// By increasing number; what is passed over is left in one.
  void add(std::uint64_t number, std::uint64_t pieces);
  struct Left {
    std::uint64_t pieces, before;  ///< of it, and of all those before it
  };
  Left of(std::uint64_t number) const;

 private:
  struct Run {
    std::uint64_t first, end, pieces;
    std::uint64_t before;  ///< left of those before the first
  };
  std::vector<Run> runs_;
};

/// What facets are called where terrain is read by tiles: by the numbers that they have where all of the
/// scene is in memory, component by component, row by row of a raster (docs/big-terrain.md).
class FacetNumbering {
 public:
  /// Of a tiled site, which outlives this; where relief is refined with the tiles, of its facets before that.
  /// Tiles that a material map or the sea surface may cut are read, to count what they leave. Throws
  /// InputError where one cannot be read, and for more facets than have numbers.
  explicit FacetNumbering(const LoadedScene& loaded_scene);
  /// Of what relief makes of those facets: all of them are refined once, some tiles at a time, and counted.
  FacetNumbering(const LoadedScene& loaded_scene, const FacetNumbering& base);

  /// By facet of a loaded scene that has these tiles; `parent`: with relief, of which facet before that each
  /// is part.
  std::vector<FacetId> of(const TileChoice& choice, std::span<const FacetId> parent = {}) const;
  /// Of the first facet of a row of tiles; of components that are not tiled, 0 is the first and only row. One
  /// row further on it is where the next component begins.
  FacetId first_of(std::size_t component, std::size_t row) const;
  std::size_t facets() const;

 private:
  void count(std::size_t component, bool cut_by_surface);
  /// In how many pieces facets of some tiles are left: by facet.
  std::vector<std::uint64_t> pieces_of(std::size_t component, std::span<const std::uint32_t> tiles,
                                       bool cut_by_surface) const;
  /// Of facets before relief, by their numbers from `first` on: those of a component in some tiles.
  void count_refined(const LoadedScene& loaded_scene, std::size_t component, const TileChoice& tiles,
                     const TileChoice& around, FacetId first, std::span<std::uint64_t> pieces) const;
  void require_numbers(std::uint64_t facets) const;
  FacetId first_before_relief(std::size_t component, std::size_t row) const;

  const Scene& scene_;
  std::vector<PieceCount> left_;  ///< by component: of each facet of its raster
  std::vector<FacetId> first_;    ///< by component, and of all; before relief
  bool is_refined_ = false;
  PieceCount refined_;  ///< of each facet before relief
};

}  // namespace tubefoot
