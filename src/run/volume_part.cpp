// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/volume_part.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "engine/certified/volume_reference.hpp"
#include "engine/echo/volume_echo.hpp"
#include "files/input_error.hpp"
#include "run/paths.hpp"

namespace tubefoot {

namespace {

Echo refracted_echo(const History& history, const Transmission& transmission, std::size_t s,
                    const ReceiveBeams& beams, const EchoModel& model) {
  const SceneWater& water = *transmission.scene().water;
  const Sensor& sensor = transmission.sensor(s);
  WaterColumn column = water.column(sensor.frequency_khz(transmission.number()));
  if (sensor.own_absorption_db_per_km(transmission.number()))
    std::ranges::fill(column.absorption_db_per_m, model.absorption_db_per_m);
  return refracted_volume_echo(
      history, beams, transmission.samples(s), model, transmission.scene().volume,
      {column, water.surface_height_m(), transmission.survey().sensors[s].sound_speed_m_s});
}

}  // namespace

void add_volume(const EchoContribution& plan, const Transmission& transmission, PingSums& sums) {
  const History& history = traced(transmission, sums);
  sums.as_echo([&] {
    for (const std::size_t s : plan.sensors) {
      if (sums.chosen(s).pings == 0) continue;
      const SensorModel model = transmission.model(s);
      const ReceiveBeams beams{transmission.beams(s),
                               transmission.sensor(s).beam_of_tube(transmission.number())};
      const RangeSamples samples = transmission.samples(s);
      const VolumeScattering& volume = transmission.scene().volume;
      const Echo echo = transmission.scene().water->refracts()
                            ? refracted_echo(history, transmission, s, beams, model.model)
                            : volume_echo(history, beams, samples, model.model, volume);
      if (!plan.tolerance) {
        sums.add(transmission, s, 1, echo.energy);
        continue;
      }
      const TransmissionSurface& surface = transmission.surface_mesh();
      sums.add(transmission, s,
               certify_volume(surface.mesh(), surface.tree(), history, transmission.request().visibility,
                              beams.of_tube, samples, model.model, volume, echo, *plan.tolerance));
    }
  });
}

void add_separate_volume(const EchoContribution& plan, const Transmission& transmission, PingSums& sums) {
  const History transmit = transmission.trace(transmission.tubes(), nullptr, false);
  for (const std::size_t s : plan.sensors) {
    if (sums.chosen(s).pings == 0) continue;
    const History receive = transmission.trace(transmission.receive_tubes(s), nullptr, false);
    const SensorModel model = transmission.model(s);
    const WorldGrid& grid = transmission.scene().grid;
    const glm::dvec3 receiver_m = grid.to_metres(receive.tubes.apex) - grid.to_metres(transmit.tubes.apex);
    const std::vector<std::uint32_t> fans = transmission.sensor(s).fan_of_tube(transmission.number());
    sums.as_echo([&] {
      sums.add(transmission, s, 1,
               bistatic_volume_echo(transmit, receive, receiver_m, transmission.beams_by_fans(s, fans),
                                    transmission.samples(s), model.model, transmission.scene().volume)
                   .energy);
    });
  }
}

void check_volume(LoadedScene& loaded_scene, const SensorSet& sensor_set) {
  Scene& scene = loaded_scene.scene;
  if (!scene.volume.any()) return;
  const SceneDescription& d = scene.description;
  if (d.sea_surface && d.water.surface_height_m && d.sea_surface->height_m != *d.water.surface_height_m)
    throw InputError(
        d.water.place,
        fmt::format("'surface_height_m' is {} m, but 'height_m' of [sea_surface] is {} m: depths of "
                    "layers need one sea surface; give both keys the same value, or remove one",
                    *d.water.surface_height_m, d.sea_surface->height_m));
  for (const SensorPings& pings : sensor_set.sensors)
    if (!(pings.sensor->samples().first_m > 0))
      throw InputError(
          pings.sensor->description().place,
          fmt::format("sensor '{}' receives from range 0 on, where volume scattering is infinite: "
                      "increase 'range_min_m'",
                      pings.sensor->description().name));
  for (const SensorPings& pings : sensor_set.sensors)
    if (path_settings(scene, pings.sensor->frequency_khz())) {
      scene.report.warnings.push_back(fmt::format(
          "{}: paths via mirrors and with several scatterings contain no volume scattering: sensor '{}' "
          "receives it along the direct path only",
          to_string(d.water.place), pings.sensor->description().name));
      break;
    }
}

}  // namespace tubefoot
