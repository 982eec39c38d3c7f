// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/signal_paths.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "run/paths.hpp"
#include "run/transmission_images.hpp"

namespace tubefoot {

void for_signal_paths(const Transmission& transmission, std::size_t s,
                      std::span<const SignalChannel> channels, const SignalPaths& take) {
  const Scene& scene = transmission.scene();
  const Sensor& sensor = transmission.sensor(s);
  const auto settings = path_settings(scene, sensor.frequency_khz());
  if (!settings) return;
  if (settings->scatterings > 1)
    throw InputError(scene.description.paths.place,
                     fmt::format("signals of sensor '{}' need single scattering, but 'scatterings' is {}: "
                                 "echoes of a second scattering have no phase; set scatterings = 1",
                                 sensor.description().name, settings->scatterings));
  if (scene.water->refracts())
    throw InputError(sensor.description().place,
                     fmt::format("signals of sensor '{}' along paths via mirrors need straight rays: set "
                                 "profile = \"constant\", or leave out the mirrors",
                                 sensor.description().name));
  try {
    const TransmissionImages images(transmission, s, *settings, PathEnds(transmission, s));
    const SensorModel model(transmission, images.surface_mesh(), s);
    if (take.scattered)
      for_coherent_paths(images.images(), model.model, channels, [&](const CoherentPath& path) {
        if (is_order_wanted(scene, path.order)) take.scattered(path);
      });
    if (take.arrived)
      for_coherent_arrivals(images.images(), model.model, channels, [&](const CoherentArrival& arrival) {
        if (is_order_wanted(scene, arrival.order)) take.arrived(arrival);
      });
  } catch (const std::length_error& error) {
    throw too_many_images(sensor.description(), error);
  }
}

}  // namespace tubefoot
