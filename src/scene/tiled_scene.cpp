// SPDX-License-Identifier: GPL-3.0-or-later

// Adds chosen tiles of tiled terrains to the mesh of a scene. Facets and vertices keep the order that they
// have in a mesh with all tiles.

#include "scene/tiled_scene.hpp"

#include <fmt/format.h>

#include <limits>
#include <numeric>

#include "files/memory_at_hand.hpp"
#include "scene/surfaces/material_map.hpp"

namespace tubefoot {
namespace {

/// Returns the facets [first, last) of a mesh as a component of another mesh, with their materials.
ComponentMesh taken_from(const FacetMesh& mesh, const WorldGrid& grid, FacetId first, FacetId last) {
  constexpr VertexId unknown = std::numeric_limits<VertexId>::max();
  ComponentMesh part;
  std::vector<VertexId> number(mesh.vertices.size(), unknown);
  for (FacetId f = first; f < last; ++f)
    for (const VertexId v : mesh.facets[f]) number[v] = 0;
  for (VertexId v = 0; v < number.size(); ++v) {
    if (number[v] == unknown) continue;
    number[v] = static_cast<VertexId>(part.points_m.size());
    part.points_m.push_back(
        grid.to_metres(mesh.vertices[v]));  // exact, because the points snap to their own grid points
  }
  for (FacetId f = first; f < last; ++f) {
    const auto& [a, b, c] = mesh.facets[f];
    part.triangles.push_back({number[a], number[b], number[c]});
    part.materials.push_back(mesh.material[f]);
  }
  return part;
}

}  // namespace

Scene with_tiles(const Scene& scene, const TileChoice& choice) {
  for (std::size_t i = 0; i < scene.tiled.size(); ++i) {
    if (!scene.tiled[i].tiles) continue;
    double facets = 0;
    for (const std::uint32_t tile : choice[i]) facets += scene.tiled[i].tiles->tiles()[tile].facets;
    require_memory(bytes_a_facet * facets, scene.description.terrains[i].place,
                   fmt::format("the {:.3g} facets of '{}' that are needed at once", facets,
                               scene.report.components[i].name),
                   "simulate fewer pings, or set 'window' of the terrain");
  }
  Scene part{.description = scene.description,
             .grid = scene.grid,
             .mesh = {},
             .frame = scene.frame,
             .material_mu = scene.material_mu,
             .material_reflection = scene.material_reflection,
             .relief = scene.relief,
             .reflectivity = scene.reflectivity,
             .scattering = scene.scattering,
             .smooth = scene.smooth,
             .mirror_phase = scene.mirror_phase,
             .water = scene.water,
             .volume = scene.volume,
             .assumed_water = scene.assumed_water,
             .sound_speed_m_s = scene.sound_speed_m_s,
             .trajectories = scene.trajectories,
             .sensor_trajectory = scene.sensor_trajectory,
             .moving = scene.moving,
             .first_ping_s = scene.first_ping_s,
             .tiled = {},
             .report = scene.report};
  MeshBuilder builder(scene.grid);
  std::vector<std::uint16_t> materials;
  FacetId first = 0;
  for (std::size_t i = 0; i < scene.report.components.size() - scene.moving.size(); ++i) {
    const auto component = static_cast<std::uint16_t>(i);
    if (scene.tiled[i].tiles) {
      ComponentMesh mesh = scene.tiled[i].tiles->read(choice[i]);
      if (scene.tiled[i].map)
        scene.tiled[i].map->apply(mesh);
      else
        mesh.materials.assign(mesh.triangles.size(), scene.tiled[i].material);
      builder.add(mesh.points_m, mesh.triangles, scene.tiled[i].material, component);
      materials.insert(materials.end(), mesh.materials.begin(), mesh.materials.end());
      continue;
    }
    FacetId last = first;
    while (last < scene.mesh.facets.size() && scene.mesh.component[last] == component) ++last;
    const ComponentMesh mesh = taken_from(scene.mesh, scene.grid, first, last);
    builder.add(mesh.points_m, mesh.triangles, 0, component);
    materials.insert(materials.end(), mesh.materials.begin(), mesh.materials.end());
    first = last;
  }
  MeshReport ignored;
  part.mesh = builder.finish(ignored);
  part.mesh.material = std::move(materials);
  add_moving(part, part.first_ping_s, part.mesh);
  return part;
}

TileChoice all_tiles(const Scene& scene) {
  TileChoice all(scene.tiled.size());
  for (std::size_t i = 0; i < scene.tiled.size(); ++i) {
    if (!scene.tiled[i].tiles) continue;
    all[i].resize(scene.tiled[i].tiles->tiles().size());
    std::iota(all[i].begin(), all[i].end(), std::uint32_t{0});
  }
  return all;
}

}  // namespace tubefoot
