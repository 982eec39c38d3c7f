// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/selection.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "files/usage_error.hpp"
#include "run/settings.hpp"
#include "run/survey.hpp"

// This file resolves the selection of a command line (sensor, pings and beams) to numbers, and builds the
// recordings of the selected part.

namespace tubefoot {
namespace {

/// A sensor with only the stored beams, for echo files, which use only its axes and samples.
class SomeBeams : public Sensor {
 public:
  SomeBeams(const Sensor& whole, const std::vector<std::uint32_t>& kept) : Sensor(whole) {
    std::vector<BeamAxis> some;
    for (const std::uint32_t beam : kept) some.push_back(beams_[beam]);
    beams_ = std::move(some);
  }
};

template <class Value>
std::vector<Value> part_of(const std::vector<Value>& all, const ChosenEchoes& chosen,
                           std::size_t values_per_ping = 1) {
  if (all.empty()) return {};
  const auto first = all.begin() + static_cast<std::ptrdiff_t>(chosen.first_ping * values_per_ping);
  return {first, first + static_cast<std::ptrdiff_t>(chosen.pings * values_per_ping)};
}

}  // namespace

std::optional<std::size_t> ChosenEchoes::place_of(std::uint32_t beam) const {
  if (all_beams) return beam;
  const auto found = std::ranges::lower_bound(beams, beam);
  if (found == beams.end() || *found != beam) return std::nullopt;
  return static_cast<std::size_t>(found - beams.begin());
}

std::vector<ChosenEchoes> chosen_of(const Survey& survey, const Selection& selection) {
  if (selection.beams && selection.beams->empty())
    throw UsageError("--beams selects no beam: leave it out to select all beams");
  const std::size_t only = selection.sensor ? survey.sensor_set->sensor_named(*selection.sensor) : 0;
  std::vector<ChosenEchoes> chosen(survey.sensors.size());
  for (std::size_t s = 0; s < chosen.size(); ++s) {
    if (selection.sensor && s != only) continue;
    const SensorPings& pings = survey.sensors[s];
    const std::string& name = pings.sensor->description().name;
    const std::size_t beams = pings.sensor->beams().size();
    chosen[s].pings = pings.times_s.size();
    if (selection.pings) {
      const PingRange range = resolved(*selection.pings, pings.times_s.size(), name);
      chosen[s].first_ping = static_cast<std::size_t>(range.first);
      chosen[s].pings = static_cast<std::size_t>(range.last - range.first + 1);
    }
    chosen[s].beams.resize(beams);
    std::iota(chosen[s].beams.begin(), chosen[s].beams.end(), 0u);
    if (selection.beams) chosen[s].beams = resolved_beams(*selection.beams, beams, name);
    chosen[s].all_beams = chosen[s].beams.size() == beams;
  }
  return chosen;
}

std::size_t first_ping(const SharedTransmissions& group, const std::vector<ChosenEchoes>& chosen) {
  for (const std::size_t s : group.sensors)
    if (chosen[s].pings > 0) return chosen[s].first_ping;
  return 0;
}

Recording recording_of(const Survey& survey, std::size_t s, const Selection& selection,
                       const ChosenEchoes& chosen) {
  const SensorPings& pings = survey.sensors[s];
  Recording recording;
  recording.sensor = pings.sensor.get();
  recording.ping_time_s = part_of(pings.times_s, chosen);
  recording.ping_pose = part_of(pings.poses, chosen);
  recording.altitude_m = part_of(pings.altitudes_m, chosen);
  recording.recorded_poses = part_of(pings.recorded_poses, chosen, pings.sensor->transmissions());
  recording.recorded_receiver_poses =
      part_of(pings.recorded_receiver_poses, chosen, pings.sensor->transmissions());
  recording.water_level_errors_m = part_of(pings.water_level_errors_m, chosen);
  recording.assumed_sensor = pings.assumed_sensor;
  recording.assumed_sound_speed_m_s = pings.assumed_sound_speed_m_s;
  recording.steering_sound_speed_m_s = pings.steering_sound_speed_m_s;
  for (const std::size_t start : pings.line_starts) {
    const std::size_t end = chosen.first_ping + chosen.pings;
    if (start >= end) break;
    if (start <= chosen.first_ping) {
      recording.line_starts = {0};
      recording.first_line = static_cast<std::size_t>(
          std::ranges::upper_bound(pings.line_starts, chosen.first_ping) - pings.line_starts.begin() - 1);
    } else {
      recording.line_starts.push_back(start - chosen.first_ping);
    }
  }
  recording.sound_speed_m_s = pings.sound_speed_m_s;
  recording.absorption_db_per_km = 1000 * absorption_db_per_m(survey.scene, *pings.sensor);
  const Sensor& sensor = *pings.sensor;
  const std::size_t transmissions = sensor.transmissions();
  for (std::size_t t = 0; t < sensor.transmit_sectors().size(); ++t)
    recording.sector_absorption_db_per_km.push_back(
        1000 * absorption_db_per_m(survey.scene, sensor, sensor.first_transmission(t)));
  if (!sensor.transmit_sectors().empty() || sensor.receiver_moves() || sensor.stabilisation().any())
    recording.transmission_pose = part_of(pings.transmission_poses, chosen, transmissions);
  if (sensor.receiver_moves()) recording.receiver_pose = part_of(pings.receiver_poses, chosen, transmissions);
  if (selection.pings) {
    recording.ping_numbers.resize(chosen.pings);
    std::iota(recording.ping_numbers.begin(), recording.ping_numbers.end(),
              static_cast<std::uint32_t>(chosen.first_ping));
  }
  if (chosen.all_beams) return recording;
  recording.beam_numbers = chosen.beams;
  recording.some_beams = std::make_shared<const SomeBeams>(*pings.sensor, chosen.beams);
  recording.sensor = recording.some_beams.get();
  return recording;
}

}  // namespace tubefoot
