// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/products/echo_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "files/usage_error.hpp"
#include "sensors/detection/bottom_detection.hpp"
#include "sensors/pictures/camera_picture.hpp"
#include "sensors/pictures/echogram.hpp"
#include "sensors/pictures/waterfall_picture.hpp"
#include "sensors/recordings/read_recording.hpp"

namespace tubefoot {
namespace {

bool are_two_sides(const Sensor& sensor) {
  const std::vector<BeamAxis>& beams = sensor.beams();
  return !sensor.is_across_track() && beams.size() == 2 && beams[0].azimuth_rad < -1.5 &&
         beams[1].azimuth_rad > 1.5;
}

Canvas echogram_of_steepest(const Recording& recording, const std::string& font) {
  const Sensor& sensor = *recording.sensor;
  const auto steepest = static_cast<std::size_t>(
      std::ranges::min_element(sensor.beams(), {}, &BeamAxis::elevation_rad) - sensor.beams().begin());
  const auto samples = static_cast<std::size_t>(sensor.samples().count);
  std::vector<float> energies;
  std::vector<double> bottoms;
  for (std::size_t ping = 0; ping < recording.pings(); ++ping) {
    const PingEnergies kept = recording.energy_of(ping);
    const std::span<const double> energy = kept.values().subspan(steepest * samples, samples);
    energies.insert(energies.end(), energy.begin(), energy.end());
    const std::optional<Detection> bottom = detect_bottom(energy, sensor.samples(), {});
    bottoms.push_back(bottom ? bottom->range_m : std::numeric_limits<double>::quiet_NaN());
  }
  const std::string said = sensor.beams().size() > 1 ? fmt::format("beam {}", steepest) : std::string();
  return draw_echogram(recording, energies, bottoms, font, said);
}

}  // namespace

Canvas draw_echoes(const Recording& recording, std::optional<std::size_t> ping, const std::string& font) {
  check(recording);
  const Sensor& sensor = *recording.sensor;
  const bool sides = are_two_sides(sensor);
  if (ping && (sides || sensor.is_across_track()))
    throw UsageError(fmt::format(
        "sensor '{}' has no picture of a single ping, because its pings form the rows of one picture",
        sensor.description().name));
  if (sides) return Waterfall(recording, font).draw();
  if (sensor.is_across_track()) return echogram_of_steepest(recording, font);
  if (recording.channels() > 1) {
    std::vector<std::size_t> all(recording.pings());
    for (std::size_t k = 0; k < all.size(); ++k) all[k] = k;
    return draw_echoes(picked(recording, all).recording, ping, font);
  }
  if (!ping && recording.pings() > 1) return draw_camera_sequence(recording, font);
  return draw_camera_frame(recording, ping.value_or(0), font);
}

}  // namespace tubefoot
