// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/facet_blocks.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <optional>

#include "files/memory_at_hand.hpp"
#include "geometry/steps/stop.hpp"
#include "run/facet_numbering.hpp"
#include "run/tiles_in_view.hpp"

// This file divides the facets of terrain that is read by tiles into blocks of consecutive numbers. Each
// block has all pings that may see its facets, and the tiles of these pings fit into the tile cache where
// possible.

namespace tubefoot {
namespace {

/// Smallest part of a block: a row of tiles, or a component without tiles.
struct Unit {
  std::size_t component, row;
  std::vector<std::size_t> pings{};
};

/// Returns the units of a scene in the order of their facet numbers. `first`: by component, its first unit.
std::vector<Unit> units_of(const Scene& scene, std::vector<std::size_t>& first) {
  std::vector<Unit> units;
  for (std::size_t i = 0; i < scene.tiled.size(); ++i) {
    first.push_back(units.size());
    const std::size_t rows = scene.tiled[i].tiles ? scene.tiled[i].tiles->rows() : 1;
    for (std::size_t row = 0; row < rows; ++row) units.push_back({i, row});
  }
  return units;
}

/// Tiles and pings of a block under construction.
class Growing {
 public:
  Growing(const Scene& scene, std::size_t pings) : scene_(scene), has_ping_(pings) {
    for (const TiledTerrain& terrain : scene.tiled)
      has_tile_.emplace_back(terrain.tiles ? terrain.tiles->tiles().size() : 0);
  }
  std::uint64_t facets() const { return facets_; }
  void add(std::size_t ping, const TileChoice& choice) {
    if (has_ping_[ping]) return;
    has_ping_[ping] = true;
    for (std::size_t i = 0; i < choice.size(); ++i)
      for (const std::uint32_t tile : choice[i]) {
        if (has_tile_[i][tile]) continue;
        has_tile_[i][tile] = true;
        facets_ += scene_.tiled[i].tiles->tiles()[tile].facets;
      }
  }
  void finish(FacetBlock& block) const {
    for (std::size_t p = 0; p < has_ping_.size(); ++p)
      if (has_ping_[p]) block.pings.push_back(p);
    block.tiles.resize(has_tile_.size());
    for (std::size_t i = 0; i < has_tile_.size(); ++i)
      for (std::uint32_t tile = 0; tile < has_tile_[i].size(); ++tile)
        if (has_tile_[i][tile]) block.tiles[i].push_back(tile);
  }

 private:
  const Scene& scene_;
  std::vector<bool> has_ping_;
  std::vector<std::vector<bool>> has_tile_;
  std::uint64_t facets_ = 0;
};

}  // namespace

std::vector<FacetBlock> facet_blocks(const Transmissions& transmissions,
                                     std::span<const ReceivedPing> pings) {
  const Survey& survey = transmissions.survey();
  if (!survey.loaded_scene->is_tiled()) {
    FacetBlock all;
    all.pings.resize(pings.size());
    std::iota(all.pings.begin(), all.pings.end(), std::size_t{0});
    return {all};
  }
  const Scene& scene = survey.scene;
  const TilesInView view(*survey.loaded_scene);
  std::vector<std::size_t> first_unit;
  std::vector<Unit> units = units_of(scene, first_unit);
  std::vector<TileChoice> choices(pings.size());
  std::vector<std::vector<std::size_t>> met(pings.size());
  tbb::parallel_for(std::size_t{0}, pings.size(), [&](std::size_t p) {
    stop_if_wanted();
    const SharedTransmissions& group = survey.sensor_set->transmissions_of(pings[p].sensor);
    choices[p] = view.of(transmissions, group, pings[p].ping);
    for (std::size_t i = 0; i < choices[p].size(); ++i)
      for (const std::uint32_t tile : choices[p][i])
        met[p].push_back(first_unit[i] + tile / scene.tiled[i].tiles->columns());
    for (const std::size_t i : view.components_of(transmissions, group, pings[p].ping))
      met[p].push_back(first_unit[i]);
    std::ranges::sort(met[p]);
    met[p].erase(std::unique(met[p].begin(), met[p].end()), met[p].end());
  });
  for (std::size_t p = 0; p < pings.size(); ++p)
    for (const std::size_t unit : met[p]) units[unit].pings.push_back(p);

  const auto most_facets =
      static_cast<std::uint64_t>(scene.description.run.terrain_cache_mb * 1e6 / bytes_a_facet /
                                 static_cast<double>(survey.loaded_scene->relief.parts_a_facet));
  const FacetNumbering& numbering = survey.loaded_scene->numbering();
  std::vector<FacetBlock> blocks;
  std::optional<Growing> growing;
  for (const Unit& unit : units) {
    if (unit.pings.empty()) continue;
    stop_if_wanted();
    if (growing) {
      Growing larger = *growing;
      for (const std::size_t p : unit.pings) larger.add(p, choices[p]);
      if (larger.facets() > most_facets) {
        growing->finish(blocks.back());
        growing.reset();
      } else {
        growing.emplace(larger);
      }
    }
    if (!growing) {
      growing.emplace(scene, pings.size());
      for (const std::size_t p : unit.pings) growing->add(p, choices[p]);
      blocks.push_back({numbering.first_of(unit.component, unit.row), 0, {}, {}});
    }
    blocks.back().end = numbering.first_of(unit.component, unit.row + 1);
  }
  if (growing) growing->finish(blocks.back());
  return blocks;
}

}  // namespace tubefoot
