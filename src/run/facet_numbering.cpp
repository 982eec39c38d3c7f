// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/facet_numbering.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numeric>

#include "geometry/steps/stop.hpp"
#include "geometry/tubes/mirror.hpp"
#include "run/loaded_scene.hpp"
#include "run/transmission_surface.hpp"
#include "scene/surfaces/material_map.hpp"

// This file numbers the facets of terrain that is read by tiles as if the whole scene were in memory. It
// counts the pieces into which material maps, the sea surface and relief divide each facet of a raster
// (docs/notes/visibility.md).

namespace tubefoot {

void PieceCount::add(std::uint64_t number, std::uint64_t pieces) {
  if (pieces == 1) return;
  if (!runs_.empty() && runs_.back().end == number && runs_.back().pieces == pieces)
    ++runs_.back().end;
  else
    runs_.push_back({number, number + 1, pieces, of(number).before});
}

PieceCount::Left PieceCount::of(std::uint64_t number) const {
  const auto after = std::ranges::upper_bound(runs_, number, {}, &Run::first);
  if (after == runs_.begin()) return {1, number};
  const Run& run = *std::prev(after);
  if (number < run.end) return {run.pieces, run.before + (number - run.first) * run.pieces};
  return {1, run.before + (run.end - run.first) * run.pieces + (number - run.end)};
}

FacetNumbering::FacetNumbering(const LoadedScene& loaded_scene)
    : scene_(loaded_scene.scene), left_(scene_.tiled.size()) {
  // the cut at the surface then follows the relief
  const bool is_cut = loaded_scene.is_cut && !loaded_scene.refines_tiles();
  std::vector<std::uint64_t> in_mesh(scene_.tiled.size());
  for (const std::uint16_t component : scene_.mesh.component) ++in_mesh[component];
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < scene_.tiled.size(); ++i) {
    first_.push_back(static_cast<FacetId>(sum));
    const TiledTerrain& terrain = scene_.tiled[i];
    if (terrain.tiles && (terrain.map || is_cut)) count(i, is_cut);
    sum += terrain.tiles ? left_[i].of(terrain.tiles->facets()).before : in_mesh[i];
    require_numbers(sum);
  }
  first_.push_back(static_cast<FacetId>(sum));
}

void FacetNumbering::require_numbers(std::uint64_t facets) const {
  if (facets >= std::numeric_limits<FacetId>::max())
    throw InputError(scene_.description.terrains.front().place,
                     fmt::format("the scene has {} facets or more, but facet numbers have only 32 bits: "
                                 "restrict the terrain to a window",
                                 facets));
}

FacetNumbering::FacetNumbering(const LoadedScene& loaded_scene, const FacetNumbering& base)
    : scene_(loaded_scene.scene), left_(base.left_), first_(base.first_), is_refined_(true) {
  constexpr std::size_t tiles_at_once = 8;
  for (std::size_t i = 0; i < scene_.tiled.size(); ++i) {
    const TerrainTiles* tiles = scene_.tiled[i].tiles.get();
    for (std::size_t row = 0; row < (tiles ? tiles->rows() : 1); ++row) {
      const FacetId first = first_before_relief(i, row);
      std::vector<std::uint64_t> pieces(first_before_relief(i, row + 1) - first, 1);
      const std::size_t columns = tiles ? tiles->columns() : 1;
      for (std::size_t column = 0; column < columns; column += tiles_at_once) {
        stop_if_wanted();
        // Includes the surrounding tiles, whose materials and normals affect the facets at their borders.
        TileChoice chosen(scene_.tiled.size()), around(scene_.tiled.size());
        for (std::size_t r = row - (row > 0); tiles && r < std::min(row + 2, tiles->rows()); ++r)
          for (std::size_t c = column - (column > 0);
               c < std::min(column + tiles_at_once + 1, tiles->columns()); ++c) {
            const auto tile = static_cast<std::uint32_t>(r * columns + c);
            if (tiles->tiles()[tile].facets == 0) continue;
            around[i].push_back(tile);
            if (r == row && c >= column && c < column + tiles_at_once) chosen[i].push_back(tile);
          }
        if (!tiles || !chosen[i].empty()) count_refined(loaded_scene, i, chosen, around, first, pieces);
      }
      for (std::size_t k = 0; k < pieces.size(); ++k) refined_.add(first + k, pieces[k]);
      require_numbers(refined_.of(first + pieces.size()).before);
    }
  }
}

void FacetNumbering::count_refined(const LoadedScene& loaded_scene, std::size_t component,
                                   const TileChoice& tiles, const TileChoice& around, FacetId first,
                                   std::span<std::uint64_t> pieces) const {
  const Scene part = with_tiles(scene_, around);
  const std::vector<FacetId> numbers = of(around), wanted = of(tiles);  // numbers before relief
  std::vector<FacetId> facets, names;
  for (FacetId f = 0; f < numbers.size(); ++f) {
    if (part.mesh.component[f] != component || !std::ranges::binary_search(wanted, numbers[f])) continue;
    facets.push_back(f);
    names.push_back(numbers[f]);
  }
  if (facets.empty()) return;
  RefinedMesh seabed = refined_part(loaded_scene, part, facets, names);
  if (loaded_scene.is_cut) cut_at_surface(part, seabed.mesh, seabed.parent);
  for (const FacetId name : names) pieces[name - first] = 0;
  for (const FacetId facet : seabed.parent) ++pieces[numbers[facet] - first];
}

std::vector<std::uint64_t> FacetNumbering::pieces_of(std::size_t component,
                                                     std::span<const std::uint32_t> tiles,
                                                     bool cut_by_surface) const {
  const TiledTerrain& terrain = scene_.tiled[component];
  ComponentMesh mesh = terrain.tiles->read(tiles);
  std::vector<std::uint64_t> pieces(mesh.triangles.size());
  std::vector<std::uint32_t> facet(mesh.triangles.size());
  std::iota(facet.begin(), facet.end(), 0u);
  if (terrain.map) facet = terrain.map->apply(mesh);
  if (cut_by_surface) {
    MeshBuilder builder(scene_.grid);
    builder.add(mesh.points_m, mesh.triangles, 0, 0);
    MeshReport ignored;
    const FacetMesh on_grid = builder.finish(ignored);
    std::vector<FacetId> all(on_grid.facets.size());
    std::iota(all.begin(), all.end(), FacetId{0});
    const MirrorPlane surface = MirrorPlane::horizontal(scene_.surface_height());
    for (const FacetId wet : in_front_of(surface, on_grid, all).origin) ++pieces[facet[wet]];
  } else {
    for (const std::uint32_t f : facet) ++pieces[f];
  }
  return pieces;
}

void FacetNumbering::count(std::size_t component, bool cut_by_surface) {
  const TiledTerrain& terrain = scene_.tiled[component];
  const TerrainTiles& tiles = *terrain.tiles;
  const double surely_below_m =
      cut_by_surface ? scene_.description.sea_surface->height_m - 2 * scene_.grid.unit_m() : 0;
  for (std::size_t row = 0; row < tiles.rows(); ++row) {
    stop_if_wanted();
    std::vector<std::uint32_t> chosen;
    for (std::size_t k = row * tiles.columns(); k < (row + 1) * tiles.columns(); ++k)
      if (const TerrainTiles::Tile& tile = tiles.tiles()[k];
          tile.facets > 0 && (terrain.map || tile.hi_m.z > surely_below_m))
        chosen.push_back(static_cast<std::uint32_t>(k));
    const std::vector<std::uint64_t> numbers = tiles.numbers_of(chosen),
                                     pieces = pieces_of(component, chosen, cut_by_surface);
    for (std::size_t k = 0; k < numbers.size(); ++k) left_[component].add(numbers[k], pieces[k]);
  }
}

FacetId FacetNumbering::first_before_relief(std::size_t component, std::size_t row) const {
  if (row == 0) return first_[component];
  const auto& tiles = scene_.tiled[component].tiles;
  if (!tiles) return first_[component + 1];
  return first_[component] + static_cast<FacetId>(left_[component].of(tiles->first_of_row(row)).before);
}

FacetId FacetNumbering::first_of(std::size_t component, std::size_t row) const {
  const FacetId first = first_before_relief(component, row);
  return is_refined_ ? static_cast<FacetId>(refined_.of(first).before) : first;
}

std::size_t FacetNumbering::facets() const {
  return is_refined_ ? refined_.of(first_.back()).before : first_.back();
}

std::vector<FacetId> FacetNumbering::of(const TileChoice& choice, std::span<const FacetId> parent) const {
  std::vector<FacetId> numbers;
  for (std::size_t i = 0; i < scene_.tiled.size(); ++i)
    if (scene_.tiled[i].tiles)
      for (const std::uint64_t number : scene_.tiled[i].tiles->numbers_of(choice[i])) {
        const auto [pieces, before] = left_[i].of(number);
        for (std::uint64_t piece = 0; piece < pieces; ++piece)
          numbers.push_back(first_[i] + static_cast<FacetId>(before + piece));
      }
    else
      for (FacetId number = first_[i]; number < first_[i + 1]; ++number) numbers.push_back(number);
  if (parent.empty()) return numbers;
  // At the border of the loaded tiles, relief may cut a facet differently than with its neighbours. No ping
  // sees such facets.
  std::vector<FacetId> refined(parent.size());
  for (std::size_t f = 0; f < parent.size(); ++f)
    refined[f] = f > 0 && parent[f] == parent[f - 1]
                     ? refined[f - 1] + 1
                     : static_cast<FacetId>(refined_.of(numbers[parent[f]]).before);
  return refined;
}

}  // namespace tubefoot
