// SPDX-License-Identifier: GPL-3.0-or-later

// Makes the facets of the sea surface, the waves that move them, and the scattering of the roughness that
// they do not show (docs/environment.md).

#include "scene/surfaces/sea_surface.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "engine/scattering/sea_surface_backscatter.hpp"

namespace tubefoot {
namespace {

/// A wave needs four cells per length: with fewer, facets cut its crests and troughs by more than 0.3 of the
/// amplitude.
constexpr double cells_per_wave = 4;
constexpr double most_facets = 2e6;

struct Lattice {
  std::vector<double> east_m, north_m;
};

std::size_t cells_along(double size_m, double cell_m) {
  return static_cast<std::size_t>(std::max(std::ceil(size_m / cell_m - 1e-9), 1.0));
}

Lattice lattice_of(const SeaSurfaceDescription& sea) {
  const auto nodes = [&](std::size_t axis) {
    const double size_m = (*sea.size_m)[axis], begin_m = sea.centre_m[axis] - size_m / 2;
    const std::size_t cells = cells_along(size_m, sea.cell_m);
    std::vector<double> at_m;
    for (std::size_t k = 0; k <= cells; ++k)
      at_m.push_back(begin_m + size_m * static_cast<double>(k) / static_cast<double>(cells));
    return at_m;
  };
  return {nodes(0), nodes(1)};
}

WaveSpectrum spectrum_of(const SeaSurfaceDescription& sea) {
  return sea.spectrum == "jonswap" ? WaveSpectrum::jonswap(sea.wind_speed_m_s, sea.fetch_m)
                                   : WaveSpectrum::pierson_moskowitz(sea.wind_speed_m_s);
}

double shortest_wave_m(const SeaSurfaceDescription& sea) { return cells_per_wave * sea.cell_m; }

/// The facets face the water below. The diagonals of neighbouring cells differ in direction.
ComponentMesh level_facets(const SeaSurfaceDescription& sea) {
  const Lattice lattice = lattice_of(sea);
  ComponentMesh mesh;
  for (const double north : lattice.north_m)
    for (const double east : lattice.east_m) mesh.points_m.emplace_back(east, north, sea.height_m);
  const auto columns = static_cast<std::uint32_t>(lattice.east_m.size()),
             rows = static_cast<std::uint32_t>(lattice.north_m.size());
  for (std::uint32_t row = 0; row + 1 < rows; ++row)
    for (std::uint32_t column = 0; column + 1 < columns; ++column) {
      const std::uint32_t a = row * columns + column, b = a + 1, c = a + columns, d = c + 1;
      if ((row + column) % 2 == 0) {
        mesh.triangles.push_back({a, c, b});
        mesh.triangles.push_back({b, c, d});
      } else {
        mesh.triangles.push_back({a, c, d});
        mesh.triangles.push_back({a, d, b});
      }
    }
  return mesh;
}

void refuse_taken_names(const SceneDescription& scene) {
  const auto refuse = [](const auto& list, std::string_view what) {
    for (const auto& one : list)
      if (one.name == sea_surface_name)
        throw InputError(one.place,
                         fmt::format("the name \"{}\" is used by the facets of [sea_surface]: give "
                                     "the {} another 'name'",
                                     sea_surface_name, what));
  };
  refuse(scene.terrains, "terrain");
  refuse(scene.objects, "object");
  refuse(scene.materials, "material");
}

}  // namespace

bool is_sea_surface(const SceneDescription& scene, std::size_t object) {
  return scene.sea_surface && scene.sea_surface->has_facets() && object + 1 == scene.objects.size();
}

SceneDescription with_sea_surface(SceneDescription scene) {
  SeaSurfaceDescription& sea = *scene.sea_surface;
  refuse_taken_names(scene);
  if (const double water_m = scene.water.surface_height_m.value_or(0);
      scene.water.profile != "constant" && water_m != sea.height_m)
    throw InputError(
        sea.place,
        fmt::format("the sea surface is at {:.6g} m, but the depths of the sound speed profile begin at "
                    "{:.6g} m: set 'surface_height_m' of [water] to 'height_m'",
                    sea.height_m, water_m));
  const double cells = static_cast<double>(cells_along((*sea.size_m)[0], sea.cell_m)) *
                       static_cast<double>(cells_along((*sea.size_m)[1], sea.cell_m));
  if (2 * cells > most_facets)
    throw InputError(sea.place,
                     fmt::format("the sea surface has {:.3g} facets, more than {:.3g}: increase 'cell_m', or "
                                 "reduce 'size_m'",
                                 2 * cells, most_facets));
  if (!sea.rms_roughness_m)
    sea.rms_roughness_m = std::sqrt(spectrum_of(sea).variance_m2(0, std::numeric_limits<double>::infinity()));
  ObjectDescription object;
  object.place = object.trajectory_place = sea.place;
  object.name = sea_surface_name;
  object.facets = std::make_shared<const ComponentMesh>(level_facets(sea));
  if (sea.material.empty()) {
    MaterialDescription material;
    material.place = sea.place;
    material.name = sea_surface_name;
    material.model = sea_surface_model;
    scene.materials.push_back(std::move(material));
    object.material = sea_surface_name;
    object.material_place = sea.place;
  } else {
    object.material = sea.material;
    object.material_place = sea.material_place;
    for (const MaterialDescription& material : scene.materials)
      if (material.name == sea.material && material.specular_loss_db)
        throw InputError(
            sea.material_place,
            fmt::format("material '{}' has 'specular_loss_db', but the mirror of the sea surface "
                        "is its mean plane: use a material without it, and 'loss_db'",
                        material.name));
  }
  scene.objects.push_back(std::move(object));
  return scene;
}

SeaSurfaceWaves sea_surface_waves(const SceneDescription& scene, std::vector<std::string>& warnings) {
  const SeaSurfaceDescription& sea = *scene.sea_surface;
  const WaveSpectrum spectrum = spectrum_of(sea);
  const WaveSurface waves(spectrum, {sea.wind_direction_deg + 180, sea.spreading}, shortest_wave_m(sea),
                          sea.seed);
  constexpr double most_of_it = 0.9;
  if (const double shown =
          waves.variance_m2() / spectrum.variance_m2(0, std::numeric_limits<double>::infinity());
      shown < most_of_it)
    warnings.push_back(fmt::format(
        "{}: the cells of the sea surface show {:.0f} % of the variance of its height: waves of the peak are "
        "{:.3g} m long, and the cells show waves of {:.3g} m or more; reduce 'cell_m'",
        to_string(sea.place), 100 * shown,
        2 * std::numbers::pi / deep_water_wavenumber(spectrum.peak_rad_s()), shortest_wave_m(sea)));
  const Lattice lattice = lattice_of(sea);
  return {std::make_shared<const WaveLattice>(waves, lattice.east_m, lattice.north_m), waves.bound_m(),
          std::sqrt(waves.variance_m2())};
}

ScatteringModel sea_surface_scattering(const SceneDescription& scene, std::vector<std::string>& warnings) {
  const SeaSurfaceDescription& sea = *scene.sea_surface;
  const auto warn = [&](const std::string& what) {
    warnings.push_back(fmt::format("{}: {}", to_string(sea.place), what));
  };
  SeaSurfaceBackscatter model{sea.wind_speed_m_s, 0, 0};
  if (sea.scattering_khz)
    model.frequency_khz = *sea.scattering_khz;
  else if (!scene.sensors.empty())
    model.frequency_khz = figures_of(scene.sensors.front()).frequency_khz;
  model.resolved_slope_variance =
      spectrum_of(sea).slope_variance(0, deep_water_frequency(shortest_wave_m(sea)));
  if (model.frequency_khz < sea_surface_lowest_khz || model.frequency_khz > sea_surface_highest_khz)
    warn(
        fmt::format("the scattering model of the sea surface is meant for {:g} to {:g} kHz, but is used at "
                    "{:g} kHz: state a 'material' for other frequencies",
                    sea_surface_lowest_khz, sea_surface_highest_khz, model.frequency_khz));
  if (model.wind_speed_m_s < sea_surface_least_wind_m_s || model.wind_speed_m_s > sea_surface_most_wind_m_s)
    warn(
        fmt::format("the scattering model of the sea surface is meant for wind speeds of {:g} to {:g} m/s, "
                    "but is used at {:g} m/s",
                    sea_surface_least_wind_m_s, sea_surface_most_wind_m_s, model.wind_speed_m_s));
  constexpr double same = 1.01;
  for (const SensorDescription& sensor : scene.sensors)
    if (const double frequency_khz = figures_of(sensor).frequency_khz,
        ratio = frequency_khz / model.frequency_khz;
        ratio > same || ratio < 1 / same)
      warn(
          fmt::format("the sea surface scatters as at {:g} kHz for all sensors, but sensor '{}' works at "
                      "{:g} kHz: use one scene per frequency, or choose 'scattering_khz'",
                      model.frequency_khz, sensor.name, frequency_khz));
  if (const double all = sea_surface_slope_variance(model.wind_speed_m_s);
      model.resolved_slope_variance > (1 - least_unresolved_slope) * all)
    warn(
        fmt::format("the facets show waves with a mean-square slope of {:.3g}, but the scattering model has "
                    "only {:.3g} for the whole sea: increase 'cell_m'",
                    model.resolved_slope_variance, all));
  return sea_surface_scattering(model);
}

}  // namespace tubefoot
