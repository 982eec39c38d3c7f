// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/water_target_places.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <optional>

#include "geometry/mesh/closed_shells.hpp"
#include "geometry/search/vertical_line.hpp"
#include "run/paths.hpp"
#include "run/scene_below.hpp"
#include "run/transmission_surface.hpp"
#include "run/water_targets.hpp"

// This file checks targets in the water before a run: their places, the frequencies of their tables, and the
// numbers of targets of populations.

namespace tubefoot {
namespace {

/// Returns whether the water ends at the sea surface.
bool ends_at_surface(const Scene& scene) {
  return has_sea_surface(scene.description) || scene.water->refracts();
}

/// Throws InputError for a population that begins above the sea surface.
void refuse_above_surface(const Scene& scene, const TargetPopulationDescription& described) {
  const double top_depth_m = described.top_depth_m.value_or(0);
  if (top_depth_m >= 0 || !ends_at_surface(scene)) return;
  throw InputError(
      described.place,
      fmt::format("the box of population '{}' ends {:.3g} m above the sea surface (at {:.6g} m): set "
                  "'top_depth_m' to 0 or more",
                  described.name, -top_depth_m, sea_surface_height_m(scene.description)));
}

/// Throws InputError for a target that no sound can reach. Uses the crossings of the vertical through the
/// target, as the checks of sensor positions do.
void refuse_hidden_target(const LoadedScene& loaded_scene, SceneBelow& below,
                          const WaterTargetDescription& described, GridPoint at) {
  const Scene& scene = loaded_scene.scene;
  const glm::dvec3 at_m = scene.grid.to_metres(at);
  const double surface_m = sea_surface_height_m(scene.description);
  if (ends_at_surface(scene) && at_m.z > surface_m)
    throw InputError(
        described.place,
        fmt::format("target '{}' is {:.3g} m above the sea surface (at {:.6g} m): lower the third "
                    "number of 'position_m'",
                    described.name, at_m.z - surface_m, surface_m));
  const auto terrains = scene.description.terrains.size();
  const auto name_of = [&](std::uint16_t component) { return scene.report.components[component].name; };
  const TransmissionSurface column = surface_in_line_with(below.in_line_with(at_m), at_m, scene.first_ping_s);
  std::vector<FacetId> near;
  facets_near_vertical(column.tree(), at, near);
  if (const auto contact = contact_at(column.mesh(), near, at)) {
    constexpr std::array<const char*, 3> parts{"a vertex", "an edge", "a facet"};
    throw InputError(described.place,
                     fmt::format("target '{}' lies exactly on {} of '{}': move it into the water by a "
                                 "millimetre or more ('position_m')",
                                 described.name, parts[static_cast<std::size_t>(contact->part)],
                                 name_of(contact->component)));
  }
  for (const VerticalCrossings& c : vertical_crossings(column.mesh(), near, at))
    if (c.component < terrains && c.above > 0 && c.below == 0)
      throw InputError(described.place,
                       fmt::format("target '{}' is {:.3g} m below the seabed ('{}') at east {:.2f}, north "
                                   "{:.2f}, up {:.2f} m: raise the third number of 'position_m'",
                                   described.name, c.lowest_above * scene.grid.unit_m(), name_of(c.component),
                                   at_m.x, at_m.y, at_m.z));
  // Relief does not open closed objects.
  const TransmissionSurface whole = surface_at(loaded_scene, scene.first_ping_s);
  near.clear();
  facets_near_vertical(whole.tree(), at, near);
  for (const VerticalCrossings& c : vertical_crossings(whole.mesh(), near, at)) {
    if (c.component < terrains || c.above == 0 || c.below == 0) continue;
    if (is_enclosed(whole.mesh(), ClosedShells(whole.mesh(), c.component), near, at))
      throw InputError(
          described.place,
          fmt::format("target '{}' is inside the closed object '{}' at east {:.3f}, north {:.3f}, "
                      "up {:.3f} m, where no sound reaches it: move it out ('position_m'), or "
                      "open the mesh of the object",
                      described.name, name_of(c.component), at_m.x, at_m.y, at_m.z));
  }
}

/// Throws InputError for a table without the frequency of a sensor.
void refuse_other_frequencies(const WaterTargetDescription& described, const StrengthOverDirection& table,
                              const SensorSet& sensor_set) {
  for (const SensorPings& pings : sensor_set.sensors)
    for (std::size_t t = 0; t < pings.sensor->transmissions(); ++t) {
      const double frequency_hz = 1e3 * pings.sensor->frequency_khz(t);
      if (table.covers(frequency_hz)) continue;
      throw InputError(
          described.strength.file_place,
          fmt::format("the target strengths of '{}' are for {:g} to {:g} Hz, but sensor '{}' uses {:g} Hz: "
                      "compute a table for this frequency with `tubefoot strength`",
                      described.name, table.frequencies_hz().front(), table.frequencies_hz().back(),
                      pings.sensor->description().name, frequency_hz));
    }
}

/// Returns the solid angle of all tubes, where overlapping tubes count twice.
double solid_angle_sr(const TubeSet& tubes) {
  const auto ray = [&](std::uint32_t k) {
    const GridPoint r = tubes.rays[k];
    return glm::normalize(glm::dvec3(r.x, r.y, r.z));
  };
  // Van Oosterom and Strackee, The solid angle of a plane triangle, 1983.
  const auto triangle = [](glm::dvec3 a, glm::dvec3 b, glm::dvec3 c) {
    return 2 * std::atan2(std::abs(glm::dot(a, glm::cross(b, c))),
                          1 + glm::dot(a, b) + glm::dot(b, c) + glm::dot(c, a));
  };
  double sum = 0;
  for (const Tube& t : tubes.tubes)
    sum += triangle(ray(t[0]), ray(t[1]), ray(t[2])) + triangle(ray(t[0]), ray(t[2]), ray(t[3]));
  return std::min(sum, 4 * std::numbers::pi);
}

/// Returns the number of values that the signals of a target have in all channels; 0 for a sensor that
/// records energies.
double signal_values_of_target(const Sensor& sensor) {
  const SignalModel* model = sensor.signals();
  if (model == nullptr) return 0;
  const double in_pulse = std::ceil(model->waveform.duration_s * model->sampling.rate_hz) + 1;
  return std::min(in_pulse, static_cast<double>(model->sampling.samples)) *
         static_cast<double>(model->array.receivers_m.size());
}

/// Throws InputError for populations with too many targets. The number in the sector of a transmission is
/// bounded by the volumes of the sector and of the population.
void refuse_too_many(const Scene& scene, const WaterTargets& targets, const SensorSet& sensor_set) {
  const auto& described = scene.description.target_populations;
  for (std::size_t k = 0; k < described.size(); ++k)
    if (!(targets.populations[k].expected() <= most_targets_of_population))
      throw InputError(
          described[k].place,
          fmt::format(
              "population '{}' has {:.3g} targets in the mean, but the limit is {:g}: reduce "
              "'density_per_m3' or the box, or describe the targets by the volume scattering of [water]",
              described[k].name, targets.populations[k].expected(), most_targets_of_population));
  for (const SensorPings& pings : sensor_set.sensors) {
    const Sensor& sensor = *pings.sensor;
    for (std::size_t t = 0; t < sensor.firings() && !described.empty(); ++t) {
      const std::size_t transmission = sensor.first_transmission(t);
      const TubeSet tubes =
          sensor.transmit_tubes(pings.transmission_pose(0, transmission), scene.grid, transmission);
      const bool refracts = scene.water->refracts();
      // No path is longer than the largest sound speed times its time.
      double speeds = 1;
      for (const ProfilePoint& point : scene.water->profile().points())
        if (refracts) speeds = std::max(speeds, point.sound_speed_m_s / pings.sound_speed_m_s);
      const double reach_m = speeds * sensor.samples().border_m(sensor.samples().count);
      // Refracted rays reach targets outside of the straight sector, so that all directions are searched.
      const double angle_sr = refracts ? 4 * std::numbers::pi : solid_angle_sr(tubes);
      const double sector_m3 = angle_sr * reach_m * reach_m * reach_m / 3;
      double expected = 0;
      std::size_t most = 0;
      for (std::size_t k = 0; k < described.size(); ++k) {
        const auto in_sector = [&](std::size_t p) {
          return targets.populations[p].density_per_m3 *
                 std::min(sector_m3, targets.populations[p].volume_m3());
        };
        expected += in_sector(k);
        if (in_sector(k) > in_sector(most)) most = k;
      }
      const double limit = refracts ? most_targets_of_refracted_transmission : most_targets_of_transmission;
      if (!(expected <= limit))
        throw InputError(
            described[most].place,
            fmt::format(
                "a transmission of sensor '{}' meets up to {:.3g} targets in the mean, but the limit {}"
                "is {:g}: reduce 'density_per_m3', the box, or the range gate of the sensor, {}or describe "
                "the targets by the volume scattering of [water]",
                sensor.description().name, expected, refracts ? "in stratified water " : "", limit,
                refracts ? "set profile = \"constant\", " : ""));
      const double of_target = signal_values_of_target(sensor);
      if (!(expected * of_target <= most_target_signal_values))
        throw InputError(
            described[most].place,
            fmt::format(
                "a ping of sensor '{}' meets up to {:.3g} targets in the mean, whose signals have {:.2g} "
                "values "
                "in all channels, but the limit is {:g}: set 'density_per_m3' to {:.2g} or less, or reduce "
                "the "
                "box, the range gate, the pulse length or the number of receivers of the sensor",
                sensor.description().name, expected, expected * of_target, most_target_signal_values,
                0.95 * described[most].density_per_m3 * most_target_signal_values / (expected * of_target)));
    }
  }
}

}  // namespace

void check_water_targets(LoadedScene& loaded_scene, const SensorSet& sensor_set) {
  Scene& scene = loaded_scene.scene;
  if (!has_water_targets(scene.description)) return;
  const std::shared_ptr<const WaterTargets>& targets = loaded_scene.targets;
  SceneBelow below(loaded_scene);
  for (std::size_t k = 0; k < targets->single.size(); ++k) {
    const WaterTargetDescription& described = scene.description.targets[k];
    refuse_hidden_target(loaded_scene, below, described, targets->single[k].at);
    if (targets->single[k].table) refuse_other_frequencies(described, *targets->single[k].table, sensor_set);
  }
  for (const TargetPopulationDescription& described : scene.description.target_populations)
    refuse_above_surface(scene, described);
  refuse_too_many(scene, *targets, sensor_set);
  const SourcePlace& first = scene.description.targets.empty()
                                 ? scene.description.target_populations.front().place
                                 : scene.description.targets.front().place;
  for (const SensorPings& pings : sensor_set.sensors)
    if (path_settings(scene, pings.sensor->frequency_khz())) {
      scene.report.warnings.push_back(fmt::format(
          "{}: paths via mirrors and with several scatterings lead to no target in the water: sensor "
          "'{}' receives targets along the direct path only",
          to_string(first), pings.sensor->description().name));
      break;
    }
}

}  // namespace tubefoot
