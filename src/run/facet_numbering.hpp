// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "scene/tiled_scene.hpp"

namespace tubefoot {

struct LoadedScene;

/// Number of pieces into which each item of a numbered sequence is divided.
class PieceCount {
 public:
  /// Sets the number of pieces of an item. Calls come with increasing item numbers; a skipped item has one
  /// piece.
  void add(std::uint64_t number, std::uint64_t pieces);
  struct Left {
    std::uint64_t pieces, before;  ///< pieces of the item, and pieces of all items before it
  };
  Left of(std::uint64_t number) const;

 private:
  struct Run {
    std::uint64_t first, end, pieces;
    std::uint64_t before;  ///< pieces of all items before the first item of the run
  };
  std::vector<Run> runs_;
};

/// Numbers of facets for terrain that is read by tiles. A facet has the same number as with the whole scene
/// in memory: component by component, and row by row of a raster (docs/notes/visibility.md).
class FacetNumbering {
 public:
  /// Numbers the facets of a tiled scene, which must outlive this object. If relief is refined with the
  /// tiles, these are the facets before relief. Reads the tiles that a material map or the sea surface may
  /// cut, and counts their pieces. Throws InputError if a tile cannot be read, and if there are more facets
  /// than facet numbers.
  explicit FacetNumbering(const LoadedScene& loaded_scene);
  /// Numbers the facets that relief makes of the facets of `base`. Refines all of them once, some tiles at a
  /// time, and counts the results.
  FacetNumbering(const LoadedScene& loaded_scene, const FacetNumbering& base);

  /// Returns the numbers by facet of a loaded scene with these tiles. `parent`: with relief, by facet, the
  /// facet before relief that contains it.
  std::vector<FacetId> of(const TileChoice& choice, std::span<const FacetId> parent = {}) const;
  /// Returns the number of the first facet of a row of tiles. A component without tiles has the single row
  /// 0. The row after the last one starts the next component.
  FacetId first_of(std::size_t component, std::size_t row) const;
  std::size_t facets() const;

 private:
  void count(std::size_t component, bool cut_by_surface);
  /// Returns, by facet of some tiles, the number of pieces that remain of it.
  std::vector<std::uint64_t> pieces_of(std::size_t component, std::span<const std::uint32_t> tiles,
                                       bool cut_by_surface) const;
  /// Counts the pieces of the facets before relief of one component in some tiles. `pieces` starts at the
  /// facet with number `first`.
  void count_refined(const LoadedScene& loaded_scene, std::size_t component, const TileChoice& tiles,
                     const TileChoice& around, FacetId first, std::span<std::uint64_t> pieces) const;
  void require_numbers(std::uint64_t facets) const;
  FacetId first_before_relief(std::size_t component, std::size_t row) const;

  const Scene& scene_;
  std::vector<PieceCount> left_;  ///< by component: pieces of each facet of its raster
  /// by component, then for the whole scene: number of the first facet before relief
  std::vector<FacetId> first_;
  bool is_refined_ = false;
  PieceCount refined_;  ///< pieces of each facet before relief
};

}  // namespace tubefoot
