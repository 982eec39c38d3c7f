// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/tiled_scene.hpp"

#include <limits>

namespace tubefoot {
namespace {

/// The facets [first, last) of a mesh as a component of another one, and what they are of.
ComponentMesh taken_from(const FacetMesh& mesh, const WorldGrid& grid, FacetId first, FacetId last) {
  constexpr VertexId unknown = std::numeric_limits<VertexId>::max();
  ComponentMesh part;
  std::vector<VertexId> number(mesh.vertices.size(), unknown);
  for (FacetId f = first; f < last; ++f)
    for (const VertexId v : mesh.facets[f]) number[v] = 0;
  for (VertexId v = 0; v < number.size(); ++v) {
    if (number[v] == unknown) continue;
    number[v] = static_cast<VertexId>(part.points_m.size());
    part.points_m.push_back(grid.to_metres(mesh.vertices[v]));  // exact: they snap to where they are
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
  Scene part{.description = scene.description,
             .grid = scene.grid,
             .mesh = {},
             .frame = scene.frame,
             .material_mu = scene.material_mu,
             .material_reflection = scene.material_reflection,
             .relief = scene.relief,
             .reflectivity = scene.reflectivity,
             .scattering = scene.scattering,
             .water = scene.water,
             .sound_speed_m_s = scene.sound_speed_m_s,
             .trajectories = scene.trajectories,
             .sensor_trajectory = scene.sensor_trajectory,
             .tiled = {},
             .report = scene.report};
  MeshBuilder builder(scene.grid);
  std::vector<std::uint16_t> materials;
  FacetId first = 0;
  for (std::size_t i = 0; i < scene.report.components.size(); ++i) {
    const auto component = static_cast<std::uint16_t>(i);
    if (scene.tiled[i].tiles) {
      const ComponentMesh mesh = scene.tiled[i].tiles->read(choice[i]);
      builder.add(mesh.points_m, mesh.triangles, scene.tiled[i].material, component);
      materials.resize(materials.size() + mesh.triangles.size(), scene.tiled[i].material);
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
  return part;
}

std::vector<std::uint64_t> facet_numbers(const Scene& scene, const TileChoice& choice) {
  std::vector<std::uint64_t> numbers;
  std::uint64_t before = 0;
  for (std::size_t i = 0; i < scene.report.components.size(); ++i) {
    const std::uint64_t facets = scene.report.components[i].facets;
    if (scene.tiled[i].tiles)
      for (const std::uint64_t number : scene.tiled[i].tiles->numbers_of(choice[i]))
        numbers.push_back(before + number);
    else
      for (std::uint64_t k = 0; k < facets; ++k) numbers.push_back(before + k);
    before += facets;
  }
  return numbers;
}

}  // namespace tubefoot
