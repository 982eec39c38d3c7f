// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/recording.hpp"

#include <fmt/format.h>

#include <stdexcept>

namespace tubefoot {

std::size_t Recording::cells() const {
  return sensor->beams().size() * static_cast<std::size_t>(sensor->samples().count);
}

std::size_t Recording::channels() const { return static_cast<std::size_t>(sensor->channels()); }

void check(const Recording& recording) {
  if (!recording.sensor) throw std::invalid_argument("a recording without a sensor cannot be written");
  const Sensor& sensor = *recording.sensor;
  const std::size_t pings = recording.ping_time_s.size();
  const std::size_t cells = pings * recording.channels() * recording.cells();
  if (pings == 0 || recording.ping_pose.size() != pings || recording.energy.size() != cells ||
      (!recording.energy_bound.empty() && recording.energy_bound.size() != cells))
    throw std::invalid_argument(fmt::format(
        "recording of '{}' does not add up: {} ping times, {} poses, {} energies for {} beams of {} samples",
        sensor.description().name, pings, recording.ping_pose.size(), recording.energy.size(),
        sensor.beams().size(), sensor.samples().count));
}

}  // namespace tubefoot
