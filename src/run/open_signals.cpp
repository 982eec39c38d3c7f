// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/open_signals.hpp"

#include <fmt/ranges.h>

#include <set>

#include "run/paths.hpp"

namespace tubefoot {
namespace {

/// Returns the contributions without a bound to all signals of a sensor.
std::vector<std::string> open_ways(const Survey& survey, std::size_t s) {
  const Sensor& sensor = *survey.sensors[s].sensor;
  const Scene& scene = survey.scene;
  std::vector<std::string> motions;
  if (path_settings(scene, sensor.frequency_khz())) motions.emplace_back("mirror paths");
  if (sensor.has_patterns()) motions.emplace_back("beam patterns");
  if (!sensor.signals()->stop_and_hop && !scene.trajectories[scene.sensor_trajectory[s]].is_fixed())
    motions.emplace_back("motion within a ping");
  return motions;
}

/// Returns the contributions without a bound from some of the facets.
std::vector<std::string> open_surfaces(const Scene& scene) {
  std::vector<std::string> surfaces;
  for (const std::uint16_t material : std::set(scene.mesh.material.begin(), scene.mesh.material.end())) {
    const SmoothSurface* surface = scene.smooth_surface(material);
    const char* what = surface == nullptr         ? "rough"
                       : surface->fluid           ? "a fluid"
                       : surface->roughness_m > 0 ? "smooth, but with 'roughness_m'"
                                                  : nullptr;
    if (what != nullptr)
      surfaces.push_back(fmt::format("'{}', which is {}", scene.description.materials[material].name, what));
  }
  return surfaces;
}

}  // namespace

std::vector<std::string> open_signals(const Survey& survey) {
  std::vector<std::string> warnings;
  for (std::size_t s = 0; s < survey.sensors.size(); ++s) {
    const Sensor& sensor = *survey.sensors[s].sensor;
    if (sensor.signals() == nullptr) continue;
    const std::vector<std::string> motions = open_ways(survey, s), surfaces = open_surfaces(survey.scene);
    const std::string what =
        !motions.empty()
            ? fmt::format("it has {}, for which there is no certified bound", fmt::join(motions, " and "))
        : !surfaces.empty() ? fmt::format("there is no certified bound for the samples of {}",
                                          fmt::join(surfaces, ", or of "))
                            : "";
    if (!what.empty())
      warnings.push_back(
          fmt::format("'{}': 'pressure_bound' is infinite in samples that receive the following: {}; "
                      "energies have finite bounds",
                      sensor.description().name, what));
  }
  return warnings;
}

}  // namespace tubefoot
