// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/sensor_set.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "files/usage_error.hpp"
#include "files/words.hpp"

namespace tubefoot {

const SharedTransmissions& SensorSet::transmissions_of(std::size_t sensor) const {
  return *std::ranges::find_if(transmissions, [&](const SharedTransmissions& group) {
    return std::ranges::find(group.sensors, sensor) != group.sensors.end();
  });
}

std::size_t SensorSet::sensor_named(const std::string& name) const {
  std::string names;
  std::vector<std::string> known;
  for (std::size_t s = 0; s < sensors.size(); ++s) {
    const std::string& own = known.emplace_back(sensors[s].sensor->description().name);
    if (own == name) return s;
    names += (s == 0 ? "'" : ", '") + own + "'";
  }
  const std::string_view meant = nearest(name, known);
  throw UsageError(fmt::format("the scene has no sensor '{}'; it has {}{}", name, names,
                               meant.empty() ? "" : fmt::format(": did you mean '{}'?", meant)));
}

SensorSet SensorSet::some_pings(std::size_t sensor, const std::vector<std::size_t>& pings) const {
  const SensorPings& all = sensors[sensor];
  SensorPings some;
  some.sensor = all.sensor;
  some.sound_speed_m_s = all.sound_speed_m_s;
  some.water = all.water;
  for (const std::size_t ping : pings) {
    some.times_s.push_back(all.times_s[ping]);
    some.poses.push_back(all.poses[ping]);
    some.altitudes_m.push_back(all.altitudes_m[ping]);
    for (std::size_t transmission = 0; transmission < all.sensor->transmissions(); ++transmission) {
      some.transmission_poses.push_back(all.transmission_pose(ping, transmission));
      if (all.sensor->has_separate_receiver())
        some.receiver_poses.push_back(all.receiver_pose(ping, transmission));
    }
  }
  return {{std::move(some)}, {SharedTransmissions{{0}}}};
}

}  // namespace tubefoot
