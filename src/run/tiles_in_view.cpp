// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/tiles_in_view.hpp"

#include <algorithm>
#include <cmath>
#include <glm/vector_relational.hpp>
#include <optional>

#include "engine/echo/receiver_pair_echo.hpp"
#include "engine/surface/sector.hpp"
#include "engine/surface/surface_mesh.hpp"
#include "engine/surface/view_bounds.hpp"
#include "geometry/search/vertical_line.hpp"
#include "run/paths.hpp"
#include "run/refraction.hpp"

// This file finds the tiles that a ping may need (docs/notes/visibility.md). It searches the bounding boxes
// of tiles in the view of the ping's tubes and within the reach of its paths.

namespace tubefoot {
namespace {

constexpr std::int32_t far_up = 1 << WorldGrid::coordinate_bits;

void add_facet(FacetMesh& mesh, GridPoint lo, GridPoint hi) {
  const auto first = static_cast<VertexId>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), {lo, hi});
  mesh.facets.push_back({first, first + 1, first});
}

/// Returns the largest distance of a path over mirrors from its start. The unfolded path is as long as the
/// reach of an image. Each further scattering starts a new path.
double farthest_of_paths(const PathSettings& settings, double reach) { return reach * settings.scatterings; }

double fastest_m_s(const SoundSpeedProfile& profile) {
  return std::ranges::max(profile.points(), {}, &ProfilePoint::sound_speed_m_s).sound_speed_m_s;
}

}  // namespace

TilesInView::TilesInView(const LoadedScene& loaded_scene)
    : loaded_scene_(loaded_scene),
      lift_m_((loaded_scene.relief.omitted ? loaded_scene.relief.omitted->largest_height_m() : 0) +
              2 * loaded_scene.scene.grid.unit_m()) {
  const Scene& scene = loaded_scene.scene;
  for (std::size_t i = 0; i < scene.tiled.size(); ++i) {
    const ComponentReport& whole = scene.report.components[i];
    Boxes& boxes = (scene.tiled[i].tiles ? boxes_ : rest_).emplace_back();
    boxes.component = i;
    if (!scene.tiled[i].tiles) {
      if (whole.facets > 0) boxes.add(0, scene.grid, whole.lo_m, whole.hi_m);
    } else {
      const std::vector<TerrainTiles::Tile>& tiles = scene.tiled[i].tiles->tiles();
      for (std::uint32_t k = 0; k < tiles.size(); ++k)
        if (tiles[k].facets > 0) boxes.add(k, scene.grid, tiles[k].lo_m, tiles[k].hi_m);
    }
  }
  // Trees refer to the meshes, which no longer move.
  for (std::vector<Boxes>* list : {&boxes_, &rest_})
    for (Boxes& boxes : *list) {
      boxes.tree = std::make_unique<SceneTree>(boxes.mesh, SceneTree::HeightFieldSearch::ignored);
      boxes.column_tree = std::make_unique<SceneTree>(boxes.columns, SceneTree::HeightFieldSearch::ignored);
    }
}

void TilesInView::Boxes::add(std::uint32_t number, const WorldGrid& grid, glm::dvec3 lo_m, glm::dvec3 hi_m) {
  tile.push_back(number);
  const GridPoint lo = grid.snap(lo_m), hi = grid.snap(hi_m);
  add_facet(mesh, lo, hi);
  add_facet(columns, {lo.x, lo.y, -far_up}, {hi.x, hi.y, far_up});
}

void TilesInView::Boxes::add_to(TileChoice& choice, const std::vector<FacetId>& found) const {
  for (const FacetId box : found) choice[component].push_back(tile[box]);
}

void TilesInView::finish(TileChoice& choice) const {
  const auto in_order = [](std::vector<std::uint32_t>& list) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  };
  for (const Boxes& boxes : boxes_) {
    const TerrainTiles& terrain = *loaded_scene_.scene.tiled[boxes.component].tiles;
    std::vector<std::uint32_t>& list = choice[boxes.component];
    in_order(list);
    // The size of an island between holes decides whether it is a height field. No island may be truncated,
    // so that the neighbours of tiles with holes are added.
    std::vector<std::uint32_t> more;
    for (const std::uint32_t tile : list) {
      if (!terrain.tiles()[tile].has_holes) continue;
      const std::size_t row = tile / terrain.columns(), column = tile % terrain.columns();
      for (std::size_t r = row - (row > 0); r <= std::min(row + 1, terrain.rows() - 1); ++r)
        for (std::size_t c = column - (column > 0); c <= std::min(column + 1, terrain.columns() - 1); ++c)
          if (const std::size_t k = r * terrain.columns() + c; terrain.tiles()[k].facets > 0)
            more.push_back(static_cast<std::uint32_t>(k));
    }
    list.insert(list.end(), more.begin(), more.end());
    in_order(list);
  }
}

TileChoice TilesInView::of(const Transmissions& transmissions, const SharedTransmissions& group,
                           std::size_t ping) const {
  TileChoice choice = looked_at(boxes_, transmissions, group, ping);
  finish(choice);
  return choice;
}

std::vector<std::size_t> TilesInView::components_of(const Transmissions& transmissions,
                                                    const SharedTransmissions& group,
                                                    std::size_t ping) const {
  const TileChoice found = looked_at(rest_, transmissions, group, ping);
  std::vector<std::size_t> components;
  for (std::size_t i = 0; i < found.size(); ++i)
    if (!found[i].empty()) components.push_back(i);
  for (const MovingObject& object : loaded_scene_.scene.moving) components.push_back(object.component);
  return components;
}

TileChoice TilesInView::looked_at(std::span<const Boxes> list, const Transmissions& transmissions,
                                  const SharedTransmissions& group, std::size_t ping) const {
  const Scene& scene = loaded_scene_.scene;
  const WorldGrid& grid = scene.grid;
  TileChoice choice(scene.tiled.size());
  for (std::size_t number = 0; number < transmissions.survey().sensor_set->transmissions_per_ping(group);
       ++number) {
    const Transmission transmission = transmissions.of(group, ping, number);
    const SensorPings& pings = transmission.pings();
    std::vector<TubeSet> sets{transmission.tubes()};
    if (transmission.has_separate_receiver())
      sets.push_back(transmission.receive_tubes(transmission.first()));
    const TubeSet middle = sets.back();  // middle of a receiver pair
    if (pings.sensor->has_receiver_pair())
      for (const ReceiverBaseline& receiver_pair :
           pings.sensor->patterns(transmission.receiver_pose(), pings.sound_speed_m_s, number).baselines)
        for (const double end : {1.0, -1.0})
          sets.push_back(moved_along(middle, receiver_pair, end, grid.unit_m()));
    for (const TubeSet& tubes : sets) {
      // Ratio by which a ray may travel farther than its range indicates.
      double stretch = 1;
      if (scene.water->refracts()) {
        const ApparentMap apparent_map =
            apparent_map_of(loaded_scene_, pings, number, grid.to_metres(tubes.apex));
        const ViewBounds view_bounds(tubes, grid.unit_m(), apparent_map);
        for (const Boxes& boxes : list)
          boxes.add_to(choice, view_bounds.facets(boxes.mesh, *boxes.tree, grid, lift_m_));
        stretch = fastest_m_s(scene.water->profile()) / apparent_map.reference_speed_m_s();
      } else {
        // Without a surface of its own, a transmission uses the height fields of the loaded scene, which it
        // sees from above. Tiles above and below its tubes may change these height fields
        // (docs/notes/visibility.md).
        const Sector sector(tubes, grid.unit_m());
        for (const Boxes& boxes : list)
          boxes.add_to(choice,
                       sector.facets(loaded_scene_.surface_mesh ? *boxes.tree : *boxes.column_tree, lift_m_));
      }
      for (const std::size_t s : group.sensors) {
        const Sensor& sensor = transmission.sensor(s);
        const std::optional<PathSettings> paths = path_settings(transmission, s);
        if (!paths) continue;
        const double reach = stretch * std::max(2 * sensor.reach(grid), tubes.reach);
        const double farthest = farthest_of_paths(*paths, reach) + lift_m_ / grid.unit_m();
        for (const Boxes& boxes : list) {
          std::vector<FacetId> found;
          boxes.column_tree->query(
              [&](const GridPoint& lo, const GridPoint& hi) {
                const auto gap = [](double low, double high) { return std::max({low, -high, 0.0}); };
                return std::hypot(gap(double(lo.x) - tubes.apex.x, double(hi.x) - tubes.apex.x),
                                  gap(double(lo.y) - tubes.apex.y, double(hi.y) - tubes.apex.y)) <= farthest;
              },
              found);
          boxes.add_to(choice, found);
        }
      }
    }
  }
  return choice;
}

TileChoice TilesInView::within(glm::dvec3 lo_m, glm::dvec3 hi_m) const {
  TileChoice choice(loaded_scene_.scene.tiled.size());
  for (const Boxes& boxes : boxes_) {
    const std::vector<TerrainTiles::Tile>& tiles = loaded_scene_.scene.tiled[boxes.component].tiles->tiles();
    for (const std::uint32_t k : boxes.tile)
      if (glm::all(glm::lessThanEqual(tiles[k].lo_m - lift_m_, hi_m)) &&
          glm::all(glm::greaterThanEqual(tiles[k].hi_m + lift_m_, lo_m)))
        choice[boxes.component].push_back(k);
  }
  return choice;
}

TileChoice TilesInView::below(glm::dvec3 place_m) const {
  TileChoice choice(loaded_scene_.scene.tiled.size());
  for (const Boxes& boxes : boxes_) {
    std::vector<FacetId> found;
    facets_near_vertical(*boxes.tree, loaded_scene_.scene.grid.snap(place_m),
                         lift_m_ / loaded_scene_.scene.grid.unit_m(), found);
    boxes.add_to(choice, found);
  }
  for (std::vector<std::uint32_t>& list : choice) std::sort(list.begin(), list.end());
  return choice;
}

std::uint64_t TilesInView::facets(const TileChoice& choice) const {
  std::uint64_t sum = 0;
  for (const Boxes& boxes : boxes_)
    for (const std::uint32_t tile : choice[boxes.component])
      sum += loaded_scene_.scene.tiled[boxes.component].tiles->tiles()[tile].facets;
  return sum * loaded_scene_.relief.parts_a_facet;
}

Survey survey_around(const Transmissions& transmissions, const SharedTransmissions& group, std::size_t ping) {
  const Survey& survey = transmissions.survey();
  if (!survey.loaded_scene->is_tiled()) return survey;
  return survey_with_tiles(survey, TilesInView(*survey.loaded_scene).of(transmissions, group, ping));
}

void for_tiles_within(const Survey& survey, glm::dvec3 lo_m, glm::dvec3 hi_m,
                      const std::function<void(const Scene&)>& look) {
  if (!survey.loaded_scene->is_tiled()) return;
  const TileChoice all = TilesInView(*survey.loaded_scene).within(lo_m, hi_m);
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t k = 0; k < all[i].size();) {
      const std::size_t columns = survey.scene.tiled[i].tiles->columns(), row = all[i][k] / columns;
      TileChoice one_row(all.size());
      for (; k < all[i].size() && all[i][k] / columns == row; ++k) one_row[i].push_back(all[i][k]);
      look(survey_with_tiles(survey, one_row).scene);
    }
}

TransmissionsAround::TransmissionsAround(const Transmissions& transmissions) : transmissions_(transmissions) {
  if (transmissions.survey().loaded_scene->is_tiled()) view_.emplace(*transmissions.survey().loaded_scene);
}

const Transmissions& TransmissionsAround::at(const SharedTransmissions& group, std::size_t ping) {
  if (!view_) return transmissions_;
  TileChoice tiles = view_->of(transmissions_, group, ping);
  if (!part_ || tiles != tiles_) {
    part_.reset();  // before the next part is loaded
    part_ = std::make_unique<const Transmissions>(survey_with_tiles(transmissions_.survey(), tiles),
                                                  transmissions_.request());
    tiles_ = std::move(tiles);
  }
  return *part_;
}

}  // namespace tubefoot
