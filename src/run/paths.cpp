// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/paths.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "engine/surface/sector.hpp"
#include "geometry/tubes/window_tubes.hpp"
#include "run/transmission.hpp"

// This file derives the settings of paths over mirrors from the scene, and the directions in which such
// paths may meet relief (docs/environment.md).

namespace tubefoot {

std::optional<PathSettings> path_settings(const Scene& scene, double frequency_khz) {
  const SceneDescription& d = scene.description;
  const auto& reflection = scene.material_reflection;
  const bool mirrors =
      d.sea_surface || std::any_of(reflection.begin(), reflection.end(), [](double r) { return r > 0; });
  if (!mirrors && !d.paths.direct && d.paths.scatterings == 1) return std::nullopt;
  PathSettings settings;
  settings.order = std::min(d.paths.order, std::max(d.paths.only_order.value_or(d.paths.order), 1));
  settings.most_images = static_cast<std::size_t>(d.paths.most_images);
  settings.cutoff_db = d.paths.cutoff_db;
  settings.direct = d.paths.direct;
  settings.scatterings = d.paths.scatterings;
  settings.patch_m = d.paths.patch_m;
  settings.mirrors.reflection = reflection;
  settings.mirrors.phase = scene.mirror_phase;
  if (d.sea_surface) {
    // Speed at the surface, where the sea is rough.
    const double speed =
        scene.water->refracts()
            ? scene.water->profile().at(scene.water->surface_height_m() - d.sea_surface->height_m)
            : scene.sound_speed_m_s;
    const double wave_number = 2000 * std::numbers::pi * frequency_khz / speed;
    settings.mirrors.surface =
        SeaSurface{scene.surface_height(), std::pow(10, -d.sea_surface->loss_db / 10),
                   std::pow(2 * wave_number * d.sea_surface->rms_roughness_m.value_or(0), 2)};
  }
  return settings;
}

std::optional<PathSettings> path_settings(const Transmission& transmission, std::size_t sensor) {
  return path_settings(transmission.scene(),
                       transmission.sensor(sensor).frequency_khz(transmission.number()));
}

namespace {

/// Returns tubes in all directions: one per octant.
TubeSet all_round(GridPoint apex, double reach) {
  WindowTubes octants(apex, reach);
  for (const double x : {-1.0, 1.0})
    for (const double y : {-1.0, 1.0})
      for (const double z : {-1.0, 1.0}) {
        std::array corners{glm::dvec3(x, 0, 0), glm::dvec3(0, y, 0), glm::dvec3(0, 0, z)};
        if (x * y * z < 0) std::swap(corners[0], corners[1]);
        octants.add(corners, 0);
      }
  return octants.tubes();
}

/// Adds the tubes of a sensor's apexes and images. They ignore hiding by other facets, so that no direction
/// is missing that relief may uncover.
void add_looks(const Transmission& transmission, std::size_t s, const PathSettings& settings,
               std::vector<PathLook>& looks) {
  const Scene& scene = transmission.scene();
  const double unit_m = scene.grid.unit_m();
  std::vector<TubeSet> apexes{transmission.tubes()};
  if (transmission.has_separate_receiver()) apexes.push_back(transmission.receive_tubes(s));
  const double beam_rad = Sector(apexes.front(), unit_m).narrowest_rad();
  for (const TubeSet& tubes : apexes) looks.push_back({tubes, beam_rad});
  // No point of a path is farther from its ends.
  if (settings.scatterings > 1)
    looks.push_back({all_round(apexes.front().apex, apexes.front().reach), std::numbers::pi / 2});
  if (settings.order < 2) return;
  if (scene.water->refracts()) {  // images look along refracted rays
    for (const TubeSet& tubes : apexes) looks.push_back({all_round(tubes.apex, tubes.reach), beam_rad});
    return;
  }
  RefinedMesh mirrors = mirrors_about(transmission, apexes.front().reach * unit_m);
  drop_sea_surface(scene, mirrors.mesh);
  const SceneTree tree(mirrors.mesh, SceneTree::HeightFieldSearch::ignored);
  const ImageFinder finder(mirrors.mesh, tree, transmission.request().visibility, settings.mirrors,
                           settings.least(), settings.most_images);
  for (TubeSet& tubes : apexes) {
    tubes.reach = 2 * transmission.sensor(s).reach(scene.grid);
    for (Image& image : finder.images_of(tubes, settings.order - 1))
      if (image.mirrors > 0) looks.push_back({std::move(image.windows), beam_rad});
  }
}

}  // namespace

InputError too_many_images(const SensorDescription& sensor, const std::length_error& error) {
  return InputError(sensor.place, fmt::format("sensor '{}', paths: {}", sensor.name, error.what()));
}

std::vector<PathLook> looks_of_paths(const Transmission& transmission) {
  std::vector<PathLook> looks;
  for (const std::size_t s : transmission.group().sensors)
    if (const auto settings = path_settings(transmission, s)) try {
        add_looks(transmission, s, *settings, looks);
      } catch (const std::length_error& error) {
        throw too_many_images(transmission.sensor(s).description(), error);
      }
  return looks;
}

std::optional<std::size_t> material_of_inclined_mirrors(const Scene& scene) {
  const FacetMesh& mesh = scene.mesh;
  const auto reflects = [&](std::size_t material) {
    return material < scene.material_reflection.size() && scene.material_reflection[material] > 0;
  };
  const auto height = [&](FacetId f, std::size_t k) { return mesh.vertices[mesh.facets[f][k]].z; };
  for (std::size_t material = 0; material < scene.relief.size(); ++material)
    if (scene.relief[material] && reflects(material)) return material;
  for (FacetId f = 0; f < mesh.facets.size(); ++f)
    if (reflects(mesh.material[f]) && (height(f, 0) != height(f, 1) || height(f, 1) != height(f, 2)))
      return mesh.material[f];
  // Tiles are not loaded yet.
  for (const TiledTerrain& terrain : scene.tiled)
    if (terrain.tiles && reflects(terrain.material)) return terrain.material;
  return std::nullopt;
}

void check_paths(const Scene& scene, const SensorSet& sensor_set) {
  const SceneDescription& d = scene.description;
  for (const SensorPings& pings : sensor_set.sensors) {
    const SensorDescription& sensor = pings.sensor->description();
    if (!path_settings(scene, pings.sensor->frequency_khz())) {
      if (d.paths.order > 1 || d.paths.only_order)
        throw InputError(d.paths.place,
                         "paths of several orders need a mirror or a second scattering: add [sea_surface], "
                         "'specular_loss_db' to a material, or 'scatterings = 2'");
      continue;
    }
    if (!d.sea_surface) continue;
    const auto check = [&](const std::string& what, double height_m) {
      if (height_m >= d.sea_surface->height_m)
        throw InputError(sensor.place,
                         fmt::format("{} is {:.3g} m above the sea surface (at {:.6g} m)", what,
                                     height_m - d.sea_surface->height_m, d.sea_surface->height_m));
    };
    const std::string name = fmt::format("sensor '{}'", sensor.name);
    for (const auto* poses : {&pings.transmission_poses, &pings.receiver_poses})
      for (const Pose& pose : *poses) check(name, pose.position_m.z);
    if (!pings.sensor->has_receiver_pair()) continue;
    for (const Pose& pose : pings.receiver_poses.empty() ? pings.transmission_poses : pings.receiver_poses)
      for (const ReceiverBaseline& receiver_pair :
           pings.sensor->patterns(pose, pings.sound_speed_m_s).baselines)
        check("the receiver pair of " + name,
              pose.position_m.z + receiver_pair.baseline_m / 2 * std::abs(receiver_pair.axis.z));
  }
}

}  // namespace tubefoot
