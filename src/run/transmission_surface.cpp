// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/transmission_surface.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>

#include "files/memory_at_hand.hpp"
#include "geometry/tubes/part_corner_weights.hpp"
#include "run/facet_numbering.hpp"
#include "run/paths.hpp"
#include "run/refined_surface_file.hpp"
#include "run/refraction.hpp"
#include "run/transmission.hpp"

// This file applies relief to the facets of a scene. It does so offline for the whole seabed, or online for
// the view of each transmission, and cuts the result at the sea surface.

namespace tubefoot {
namespace {

/// A facet of a refined seabed takes about 60 bytes, including its share of vertices and tree.
constexpr RefinementLimits most_offline{.facets = 100'000'000}, most_per_transmission{.facets = 20'000'000};

std::vector<bool> mirror_materials(const Scene& scene) {
  std::vector<bool> mirrors;
  for (const double reflection : scene.material_reflection) mirrors.push_back(reflection > 0);
  return mirrors;
}

bool has_relief(const Scene& scene) {
  return std::any_of(scene.relief.begin(), scene.relief.end(), [](const auto& r) { return r != nullptr; });
}

std::size_t facets_of(const Scene& scene) {
  std::size_t sum = 0;
  for (const ComponentReport& component : scene.report.components) sum += component.facets;
  return sum;
}

std::vector<FacetId> all_facets(const FacetMesh& mesh) {
  std::vector<FacetId> all(mesh.facets.size());
  std::iota(all.begin(), all.end(), FacetId{0});
  return all;
}

double cell_of(const Scene& scene) {
  const RefinementDescription& keys = scene.description.refinement;
  if (keys.cell_m) return *keys.cell_m;
  double finest = 0;
  for (const auto& field : scene.relief)
    if (field) finest = finest > 0 ? std::min(finest, field->finest_m()) : field->finest_m();
  return finest;
}

void check_cell(const Scene& scene, double cell_m) {
  const SourcePlace& place = scene.description.refinement.place;
  constexpr double least_units = 16;
  if (!(cell_m >= least_units * scene.grid.unit_m()))
    throw InputError(
        place,
        fmt::format(
            "cells of {:.3g} m are too small for the grid unit of {:.3g} m: 'cell_m' must be {:.3g} or more",
            cell_m, scene.grid.unit_m(), least_units * scene.grid.unit_m()));
  double longest2 = 0;
  for (const auto& f : scene.mesh.facets)
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec3 d = scene.grid.to_metres(scene.mesh.vertices[f[k]]) -
                           scene.grid.to_metres(scene.mesh.vertices[f[(k + 1) % 3]]);
      longest2 = std::max(longest2, glm::dot(d, d));
    }
  for (const TiledTerrain& terrain : scene.tiled)
    if (terrain.tiles) longest2 = std::max(longest2, std::pow(terrain.tiles->longest_edge_m(), 2));
  // Neighbours of different size need a few more halvings.
  const double finest = std::sqrt(longest2) / std::exp2(deepest_refinement - 4);
  if (cell_m < finest)
    throw InputError(place,
                     fmt::format("a facet with an edge of {:.6g} m cannot be refined to cells of {:.3g} m: "
                                 "use smaller facets for the terrain, or a 'cell_m' of {:.3g} or more",
                                 std::sqrt(longest2), cell_m, finest));
}

/// Throws InputError for moving objects with relief or with a file of refined facets, which belong to facets
/// at rest.
void check_moving(const Scene& scene) {
  for (const MovingObject& object : scene.moving) {
    const ObjectDescription& described =
        scene.description.objects[object.component - scene.description.terrains.size()];
    for (const std::uint16_t material : object.shape.material)
      if (scene.relief[material])
        throw InputError(described.place,
                         fmt::format("object '{}' moves, but its material '{}' has relief: use a material "
                                     "without relief",
                                     described.name, scene.description.materials[material].name));
    if (scene.description.refinement.file)
      throw InputError(described.trajectory_place,
                       fmt::format("object '{}' moves, but 'file' of [relief] contains facets at rest: leave "
                                   "out 'file'",
                                   described.name));
  }
}

/// Appends the moving objects at a time to the refined facets at rest of a scene.
void append_moving(const Scene& scene, double time_s, RefinedMesh& refined) {
  FacetId parent = first_moving_facet(scene, scene.mesh);
  add_moving(scene, time_s, refined.mesh);
  while (refined.parent.size() < refined.mesh.facets.size()) refined.parent.push_back(parent++);
}

}  // namespace

std::unique_ptr<SurfaceMesh> relief_surface(const Scene& scene, const FacetMesh& base) {
  const RefinementDescription& keys = scene.description.refinement;
  if (!has_relief(scene))
    throw InputError(keys.place, keys.mode == "off"
                                     ? "[relief] has mode = \"off\": there is nothing to refine"
                                     : "no material of the scene has [[materials.relief]]: there is nothing "
                                       "to refine");
  const double cell_m = cell_of(scene);
  check_cell(scene, cell_m);
  return std::make_unique<SurfaceMesh>(
      base, scene.grid, scene.relief,
      SurfaceSettings{cell_m, keys.displace == "normal" ? Displacement::normal : Displacement::vertical,
                      keys.tolerance.value_or(SurfaceSettings().tolerance), mirror_materials(scene)});
}

RefinedMesh refined_seabed(const Scene& scene, const SurfaceMesh& surface_mesh) {
  const std::size_t count = surface_mesh.uniform_count();
  const auto too_many = [&] {
    return InputError(scene.description.refinement.place,
                      fmt::format("a seabed with cells of {:.3g} m has {} facets, more than {}: use mode = "
                                  "\"online\", a larger 'cell_m' or a smaller terrain",
                                  surface_mesh.settings().cell_m, count, most_offline.facets));
  };
  if (count > most_offline.facets) throw too_many();
  require_memory(
      bytes_a_facet * static_cast<double>(count), scene.description.refinement.place,
      fmt::format("a seabed with cells of {:.3g} m and its {} facets", surface_mesh.settings().cell_m, count),
      "use mode = \"online\", a larger 'cell_m' or a smaller terrain");
  try {
    return surface_mesh.everywhere(most_offline);
  } catch (const RefinementTooLarge&) {
    throw too_many();
  }
}

RefinedMesh refined_part(const LoadedScene& whole, const Scene& part, std::span<const FacetId> facets,
                         std::span<const FacetId> names) {
  const SourcePlace& place = part.description.refinement.place;
  if (whole.relief.file) {
    RefinedMesh seabed = whole.relief.file->read(names);
    for (FacetId& facet : seabed.parent)
      facet = facets[std::size_t(std::ranges::lower_bound(names, facet) - names.begin())];
    return seabed;
  }
  const auto at_hand = static_cast<std::size_t>(std::min(memory_at_hand() / bytes_a_facet, 1e12));
  const RefinementLimits most{.facets = std::min(most_offline.facets, at_hand)};
  try {
    return relief_surface(part, part.mesh)->everywhere(facets, most);
  } catch (const RefinementTooLarge&) {
    throw InputError(
        place,
        fmt::format("the tiles that are needed at the same time have more than {} facets with cells of "
                    "{:.3g} m: use mode = \"online\", a larger 'cell_m', fewer pings or a shorter range",
                    most.facets, whole.relief.cell_m));
  }
}

void refine_part(const LoadedScene& whole, const TileChoice& tiles, LoadedScene& part) {
  part.surface_mesh.reset();
  std::vector<FacetId> facets = all_facets(part.scene.mesh);
  facets.resize(first_moving_facet(part.scene, part.scene.mesh));
  RefinedMesh seabed =
      refined_part(whole, part.scene, facets, whole.relief.file ? whole.base_numbering().of(tiles) : facets);
  append_moving(part.scene, part.scene.first_ping_s, seabed);
  part.scene.mesh = std::move(seabed.mesh);
  part.relief.parent = std::move(seabed.parent);
}

void lay_relief(LoadedScene& loaded_scene) {
  Scene& scene = loaded_scene.scene;
  if (!has_relief(scene)) return;
  check_moving(scene);
  const RefinementDescription& keys = scene.description.refinement;
  std::unique_ptr<SurfaceMesh> surface_mesh = relief_surface(scene, resting_facets(loaded_scene));
  loaded_scene.relief.cell_m = surface_mesh->settings().cell_m;
  loaded_scene.relief.base_facets = facets_of(scene);
  if (!loaded_scene.is_tiled())
    loaded_scene.relief.uniform_facets =
        surface_mesh->uniform_count() + scene.mesh.facets.size() - first_moving_facet(scene, scene.mesh);
  loaded_scene.relief.omitted = std::make_shared<const OmittedRelief>(surface_mesh->omitted());
  if (keys.mode == "online") {
    loaded_scene.surface_mesh = std::move(surface_mesh);
    return;
  }
  std::shared_ptr<const RefinedSurfaceFile> file;
  if (keys.file)
    file = std::make_shared<const RefinedSurfaceFile>(*keys.file, keys.file_place, scene,
                                                      loaded_scene.relief.cell_m);
  if (loaded_scene.is_tiled()) {
    double longest_m = 0;
    for (const TiledTerrain& terrain : scene.tiled)
      if (terrain.tiles) longest_m = std::max(longest_m, terrain.tiles->longest_edge_m());
    // Relief halves the longest edge until it is at most a cell long. Shorter edges are halved no more
    // often.
    for (; longest_m > loaded_scene.relief.cell_m; longest_m /= 2) loaded_scene.relief.parts_a_facet *= 4;
    loaded_scene.relief.file = std::move(file);
    return;
  }
  RefinedMesh seabed = file ? file->read(all_facets(scene.mesh)) : refined_seabed(scene, *surface_mesh);
  surface_mesh.reset();
  loaded_scene.at_rest.reset();
  append_moving(scene, scene.first_ping_s, seabed);
  scene.mesh = std::move(seabed.mesh);
  loaded_scene.relief.parent = std::move(seabed.parent);
}

namespace {

template <class Refine>
RefinedMesh refined_for(const Transmission& transmission, const Refine& refine) {
  try {
    return refine();
  } catch (const RefinementTooLarge&) {
    throw InputError(transmission.scene().description.refinement.place,
                     fmt::format("{} has more than {} facets in view: use a larger 'cell_m' or 'tolerance'",
                                 transmission.name(), most_per_transmission.facets));
  }
}

}  // namespace

RefinedMesh relief_seen_by(const Transmission& transmission, std::span<const Look> looks, bool weights) {
  RefinedMesh seabed = refined_for(transmission, [&] {
    return transmission.loaded_scene().surface_mesh->seen_by(looks, {most_per_transmission.facets, weights});
  });
  append_moving(transmission.scene(), transmission.time_s(), seabed);
  if (weights) seabed.weights.resize(seabed.mesh.facets.size(), all_of_it);
  cut_at_surface(transmission.scene(), seabed.mesh, seabed.parent, weights ? &seabed.weights : nullptr);
  return seabed;
}

RefinedMesh mirrors_about(const Transmission& transmission, double distance_m) {
  RefinedMesh mirrors = refined_for(transmission, [&] {
    return transmission.loaded_scene().surface_mesh->mirrors_within(transmission.pose().position_m,
                                                                    distance_m, most_per_transmission);
  });
  append_moving(transmission.scene(), transmission.time_s(), mirrors);
  cut_at_surface(transmission.scene(), mirrors.mesh, mirrors.parent);
  return mirrors;
}

namespace {

/// Returns the numbers of facets and of vertices of the sea surface at the end of a mesh.
std::array<std::size_t, 2> sea_surface_sizes(const Scene& scene, const FacetMesh& mesh) {
  const MovingObject* const sea = moving_sea_surface_of(scene);
  if (sea == nullptr || mesh.component.empty() || mesh.component.back() != sea->component) return {0, 0};
  return {sea->shape.facets.size(), sea->points_m.size()};
}

bool reaches_above_water(const Scene& scene, const FacetMesh& mesh) {
  if (!scene.description.sea_surface) return false;
  const std::int32_t height = scene.surface_height();
  const std::span<const GridPoint> vertices(mesh.vertices);
  return std::ranges::any_of(vertices.first(vertices.size() - sea_surface_sizes(scene, mesh)[1]),
                             [=](GridPoint v) { return v.z > height; });
}

/// Appends the last facets of a mesh, which share no vertex with the others, to another mesh.
void append_last(const FacetMesh& from, std::size_t facets, std::size_t vertices, FacetMesh& to) {
  const std::size_t first_facet = from.facets.size() - facets, first_vertex = from.vertices.size() - vertices;
  const auto shift = static_cast<VertexId>(to.vertices.size() - first_vertex);  // modulo 2^32
  to.vertices.insert(to.vertices.end(), from.vertices.begin() + static_cast<std::ptrdiff_t>(first_vertex),
                     from.vertices.end());
  for (std::size_t f = first_facet; f < from.facets.size(); ++f) {
    const auto& [a, b, c] = from.facets[f];
    to.facets.push_back({a + shift, b + shift, c + shift});
    to.material.push_back(from.material[f]);
    to.component.push_back(from.component[f]);
  }
}

}  // namespace

void drop_sea_surface(const Scene& scene, FacetMesh& mesh) {
  const auto [facets, vertices] = sea_surface_sizes(scene, mesh);
  mesh.facets.resize(mesh.facets.size() - facets);
  mesh.material.resize(mesh.facets.size());
  mesh.component.resize(mesh.facets.size());
  mesh.vertices.resize(mesh.vertices.size() - vertices);
}

bool has_path_surface(const Scene& scene) { return moving_sea_surface_of(scene) != nullptr; }

bool cut_at_surface(const Scene& scene, FacetMesh& mesh, std::vector<FacetId>& parent,
                    std::vector<PartWeights>* weights) {
  if (!reaches_above_water(scene, mesh)) return false;
  const std::int32_t height = scene.surface_height();
  std::vector<std::array<PartCorner, 3>> corners;
  const auto [sea_facets, sea_vertices] = sea_surface_sizes(scene, mesh);
  std::vector<FacetId> others = all_facets(mesh);
  others.resize(others.size() - sea_facets);
  MeshPart wet =
      in_front_of(MirrorPlane::horizontal(height), mesh, others, weights == nullptr ? nullptr : &corners);
  append_last(mesh, sea_facets, sea_vertices, wet.mesh);
  std::vector<PartWeights> of_sea;
  for (std::size_t f = mesh.facets.size() - sea_facets; f < mesh.facets.size(); ++f) {
    wet.origin.push_back(static_cast<FacetId>(f));
    if (weights != nullptr) of_sea.push_back((*weights)[f]);
  }
  mesh = std::move(wet.mesh);
  if (weights != nullptr) {
    std::vector<PartWeights> parts(corners.size());
    for (std::size_t f = 0; f < parts.size(); ++f)
      parts[f] = weights_of(corners[f], (*weights)[wet.origin[f]]);
    parts.insert(parts.end(), of_sea.begin(), of_sea.end());
    *weights = std::move(parts);
  }
  if (!parent.empty()) {
    for (FacetId& facet : wet.origin) facet = parent[facet];
    parent = std::move(wet.origin);
  }
  return true;
}

TransmissionSurface moved_surface_of(const Transmission& transmission, bool weights) {
  const LoadedScene& loaded_scene = transmission.loaded_scene();
  TransmissionSurface surface = surface_at(loaded_scene, transmission.time_s());
  if (!reaches_above_water(loaded_scene.scene, surface.mesh())) return surface;
  RefinedMesh cut{surface.mesh(), all_facets(surface.mesh()), {}};
  if (weights) cut.weights.assign(cut.mesh.facets.size(), all_of_it);
  cut_at_surface(loaded_scene.scene, cut.mesh, cut.parent, weights ? &cut.weights : nullptr);
  return TransmissionSurface(loaded_scene, std::move(cut));
}

TransmissionSurface surface_mesh_of(const Transmission& transmission, bool weights) {
  return transmission.scene().water->refracts() ? refracted_surface_of(transmission, weights)
                                                : lying_surface_of(transmission, weights);
}

TransmissionSurface lying_surface_of(const Transmission& transmission, bool weights) {
  const LoadedScene& loaded_scene = transmission.loaded_scene();
  if (!loaded_scene.surface_mesh)
    return loaded_scene.moving ? moved_surface_of(transmission, weights) : TransmissionSurface(loaded_scene);
  std::vector<TubeSet> tubes{transmission.tubes()};
  if (transmission.has_separate_receiver()) tubes.push_back(transmission.receive_tubes(transmission.first()));
  std::vector<Look> looks = transmission.looks(tubes);
  const std::vector<PathLook> of_paths = looks_of_paths(transmission);
  for (const PathLook& look : of_paths)
    looks.push_back({&look.tubes, 0, transmission.sample_length_m(), nullptr, look.beam_rad});
  return TransmissionSurface(loaded_scene, relief_seen_by(transmission, looks, weights));
}

TransmissionSurface path_surface_of(const Transmission& transmission, bool weights) {
  TransmissionSurface surface = lying_surface_of(transmission, weights);
  const Scene& scene = transmission.scene();
  if (!has_path_surface(scene)) return surface;
  RefinedMesh dry = surface.refined() != nullptr
                        ? *surface.refined()
                        : RefinedMesh{surface.mesh(), all_facets(surface.mesh()), {}};
  if (weights && dry.weights.empty()) dry.weights.assign(dry.mesh.facets.size(), all_of_it);
  drop_sea_surface(scene, dry.mesh);
  dry.parent.resize(dry.mesh.facets.size());
  if (weights) dry.weights.resize(dry.mesh.facets.size(), all_of_it);
  return TransmissionSurface(transmission.loaded_scene(), std::move(dry));
}

TransmissionSurface surface_at(const LoadedScene& loaded_scene, double time_s) {
  if (!loaded_scene.moving) return TransmissionSurface(loaded_scene);
  return TransmissionSurface(loaded_scene, loaded_scene.moving->at(time_s));
}

TransmissionSurface surface_in_line_with(const LoadedScene& loaded_scene, glm::dvec3 place_m, double time_s) {
  if (!loaded_scene.surface_mesh) return surface_at(loaded_scene, time_s);
  RefinedMesh column = loaded_scene.surface_mesh->in_line_with(place_m);
  append_moving(loaded_scene.scene, time_s, column);
  return TransmissionSurface(loaded_scene, std::move(column));
}

}  // namespace tubefoot
