// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/paths.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

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
  if (d.sea_surface) {
    // At the surface, where it is rough.
    const double speed =
        scene.water->refracts()
            ? scene.water->profile().at(scene.water->surface_height_m() - d.sea_surface->height_m)
            : scene.sound_speed_m_s;
    const double wave_number = 2000 * std::numbers::pi * frequency_khz / speed;
    settings.mirrors.surface = SeaSurface{scene.surface_height(), std::pow(10, -d.sea_surface->loss_db / 10),
                                          std::pow(2 * wave_number * d.sea_surface->rms_roughness_m, 2)};
  }
  return settings;
}

std::optional<std::size_t> material_of_inclined_mirrors(const Scene& scene) {
  const FacetMesh& mesh = scene.mesh;
  const auto reflects = [&](std::size_t material) {
    return material < scene.material_reflection.size() && scene.material_reflection[material] > 0;
  };
  const auto height = [&](FacetId f, std::size_t k) { return mesh.vertices[mesh.facets[f][k]].z; };
  for (FacetId f = 0; f < mesh.facets.size(); ++f)
    if (reflects(mesh.material[f]) && (height(f, 0) != height(f, 1) || height(f, 1) != height(f, 2)))
      return mesh.material[f];
  // Tiles are not there yet.
  for (const TiledTerrain& terrain : scene.tiled)
    if (terrain.tiles && reflects(terrain.material)) return terrain.material;
  return std::nullopt;
}

void check_paths(const Scene& scene, const Fleet& fleet) {
  const SceneDescription& d = scene.description;
  for (const SensorPings& pings : fleet.sensors) {
    const SensorDescription& sensor = pings.sensor->description();
    if (!path_settings(scene, pings.sensor->frequency_khz())) {
      if (d.paths.order > 1 || d.paths.only_order)
        throw InputError(d.paths.place,
                         "paths of several orders need a mirror or a second scattering: add [sea_surface], "
                         "'specular_loss_db' to a material, or 'scatterings = 2'");
      continue;
    }
    if (!d.sea_surface) continue;
    for (const auto* poses : {&pings.shot_poses, &pings.receiver_poses})
      for (const Pose& pose : *poses)
        if (pose.position_m.z >= d.sea_surface->height_m)
          throw InputError(
              sensor.place,
              fmt::format("sensor '{}' is {:.3g} m above the sea surface (at {:.6g} m)", sensor.name,
                          pose.position_m.z - d.sea_surface->height_m, d.sea_surface->height_m));
  }
}

}  // namespace tubefoot
