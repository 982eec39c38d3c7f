// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/facet_numbering.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numeric>

#include "geometry/steps/stop.hpp"
#include "geometry/tubes/mirror.hpp"
#include "run/site.hpp"
#include "scene/beds/material_map.hpp"

namespace tubefoot {

FacetNumbering::FacetNumbering(const Site& site) : scene_(site.scene), runs_(scene_.tiled.size()) {
  std::vector<std::uint64_t> in_mesh(scene_.tiled.size());
  for (const std::uint16_t component : scene_.mesh.component) ++in_mesh[component];
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < scene_.tiled.size(); ++i) {
    first_.push_back(static_cast<FacetId>(sum));
    const TiledTerrain& terrain = scene_.tiled[i];
    if (terrain.tiles && (terrain.map || site.is_cut)) count(i, site.is_cut);
    sum += terrain.tiles ? left(i, terrain.tiles->facets()).before : in_mesh[i];
    if (sum >= std::numeric_limits<FacetId>::max())
      throw InputError(scene_.description.terrains.front().place,
                       fmt::format("facets are numbered in 32 bits, and the scene has {} or more: give the "
                                   "terrain a window",
                                   sum));
  }
  first_.push_back(static_cast<FacetId>(sum));
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
  std::vector<Run>& runs = runs_[component];
  for (std::size_t row = 0; row < tiles.rows(); ++row) {
    stop_if_wanted();
    std::vector<std::uint32_t> chosen;
    for (std::size_t k = row * tiles.columns(); k < (row + 1) * tiles.columns(); ++k)
      if (const TerrainTiles::Tile& tile = tiles.tiles()[k];
          tile.facets > 0 && (terrain.map || tile.hi_m.z > surely_below_m))
        chosen.push_back(static_cast<std::uint32_t>(k));
    const std::vector<std::uint64_t> numbers = tiles.numbers_of(chosen),
                                     pieces = pieces_of(component, chosen, cut_by_surface);
    for (std::size_t k = 0; k < numbers.size(); ++k) {
      if (pieces[k] == 1) continue;
      if (!runs.empty() && runs.back().end == numbers[k] && runs.back().pieces == pieces[k])
        ++runs.back().end;
      else
        runs.push_back({numbers[k], numbers[k] + 1, pieces[k], left(component, numbers[k]).before});
    }
  }
}

FacetNumbering::Left FacetNumbering::left(std::size_t component, std::uint64_t number) const {
  const std::vector<Run>& runs = runs_[component];
  const auto after = std::ranges::upper_bound(runs, number, {}, &Run::first);
  if (after == runs.begin()) return {1, number};
  const Run& run = *std::prev(after);
  if (number < run.end) return {run.pieces, run.before + (number - run.first) * run.pieces};
  return {1, run.before + (run.end - run.first) * run.pieces + (number - run.end)};
}

FacetId FacetNumbering::first_of(std::size_t component, std::size_t row) const {
  if (row == 0) return first_[component];
  const auto& tiles = scene_.tiled[component].tiles;
  if (!tiles) return first_[component + 1];
  return first_[component] + static_cast<FacetId>(left(component, tiles->first_of_row(row)).before);
}

std::vector<FacetId> FacetNumbering::of(const TileChoice& choice) const {
  std::vector<FacetId> numbers;
  for (std::size_t i = 0; i < scene_.tiled.size(); ++i)
    if (scene_.tiled[i].tiles)
      for (const std::uint64_t number : scene_.tiled[i].tiles->numbers_of(choice[i])) {
        const auto [pieces, before] = left(i, number);
        for (std::uint64_t piece = 0; piece < pieces; ++piece)
          numbers.push_back(first_[i] + static_cast<FacetId>(before + piece));
      }
    else
      for (FacetId number = first_[i]; number < first_[i + 1]; ++number) numbers.push_back(number);
  return numbers;
}

}  // namespace tubefoot
