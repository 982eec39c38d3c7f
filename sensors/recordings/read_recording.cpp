// SPDX-License-Identifier: GPL-3.0-or-later
// Builds recordings from echo files, and from selected pings of other recordings, so that pictures and
// tables can be made of them. The sensor of such a recording has beams and samples, and no transmissions.

#include "sensors/recordings/read_recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>

#include "files/input_error.hpp"
#include "sensors/model/angles.hpp"

namespace tubefoot {
namespace {

class PlainSensor : public Sensor {
 public:
  PlainSensor(SensorDescription description, double frequency_khz, std::vector<BeamAxis> beams,
              RangeSamples samples, bool across_track)
      : Sensor(without_patterns(std::move(description))) {
    frequency_khz_ = frequency_khz;
    beams_ = std::move(beams);
    samples_ = samples;
    across_track_ = across_track;
  }

 private:
  /// Removes the patterns, because they may refer to files.
  static SensorDescription without_patterns(SensorDescription description) {
    description.transmit = description.receive = {};
    return description;
  }
};

double number(const WholeEchoFile::More& more, const char* name) {
  const EchoAttribute* found = more.attribute(name);
  const double* value = found ? std::get_if<double>(&found->value) : nullptr;
  return value ? *value : 0;
}

/// A variable's values if it lies along `dimensions`; otherwise empty.
std::vector<double> values(const WholeEchoFile::More& more, const char* name,
                           const std::vector<std::string>& dimensions, std::size_t count) {
  const EchoVariable* found = more.variable(name);
  return found && found->along(dimensions) && found->values.size() == count ? found->values
                                                                            : std::vector<double>();
}

std::vector<BeamAxis> beams_of(const SensorEchoes& echoes, const WholeEchoFile::More& more) {
  const auto wide = values(more, "beam_azimuth_width", {"beam"}, echoes.beams),
             tall = values(more, "beam_elevation_width", {"beam"}, echoes.beams),
             tilt = values(more, "beam_tilt", {"beam"}, echoes.beams);
  const auto at = [](const std::vector<double>& degrees, std::size_t beam) {
    return degrees.empty() ? 0 : radians(degrees[beam]);
  };
  std::vector<BeamAxis> beams;
  for (std::size_t b = 0; b < echoes.beams; ++b)
    beams.push_back({at(echoes.beam_azimuth_deg, b), at(echoes.beam_elevation_deg, b), at(wide, b),
                     at(tall, b), at(tilt, b)});
  return beams;
}

/// True for beams that look down, or down and to the sides, and for tilted ones (beam_tilt), except for a
/// pair of opposite sides.
bool are_across(const std::vector<BeamAxis>& beams) {
  constexpr double right_angle = std::numbers::pi / 2, near = 1e-6;
  const bool all = std::ranges::all_of(beams, [](const BeamAxis& beam) {
    return beam.tilt_rad != 0 || std::abs(std::abs(beam.azimuth_rad) - right_angle) < near ||
           std::abs(beam.elevation_rad + right_angle) < near;
  });
  return all && beams.size() != 2;
}

RangeSamples samples_of(const SensorEchoes& echoes, const std::string& file) {
  const std::vector<double>& centres = echoes.slant_range_m;
  const auto last = static_cast<double>(echoes.samples - 1);
  RangeSamples samples{0, 0, static_cast<int>(echoes.samples)};
  if (!echoes.slant_range_bounds_m.empty()) {
    const std::vector<double>& edges = echoes.slant_range_bounds_m;
    samples.first_m = edges.front();
    samples.step_m = (edges.back() - edges.front()) / (last + 1);
  } else {
    samples.step_m = last > 0 ? (centres.back() - centres.front()) / last : 2 * centres.front();
    samples.first_m = centres.front() - samples.step_m / 2;
  }
  for (std::size_t k = 0; k < centres.size(); ++k)
    if (!(samples.step_m > 0) ||
        std::abs(centres[k] - samples.first_m - (static_cast<double>(k) + 0.5) * samples.step_m) >
            0.01 * samples.step_m)
      throw InputError({file}, fmt::format("the samples of sensor '{}' are not evenly spaced: sample {} is "
                                           "at {} m; pictures need evenly spaced samples",
                                           echoes.name, k, centres[k]));
  return samples;
}

/// The numbers of consecutive pings. The result is empty for numbers that are not consecutive and for an
/// empty list.
std::vector<std::uint32_t> consecutive(const std::vector<double>& numbers) {
  std::vector<std::uint32_t> result;
  for (const double number : numbers) {
    if (!(number >= 0 && number <= std::numeric_limits<std::int32_t>::max()) ||
        number != std::floor(number) || number != numbers.front() + static_cast<double>(result.size()))
      return {};
    result.push_back(static_cast<std::uint32_t>(number));
  }
  return result;
}

std::vector<std::size_t> line_starts(const std::vector<double>& line) {
  std::vector<std::size_t> starts;
  for (std::size_t ping = 0; ping < line.size(); ++ping)
    if (ping == 0 || line[ping] != line[ping - 1]) starts.push_back(ping);
  return starts;
}

}  // namespace

ReadRecording recording_of(const WholeEchoFile& file, std::size_t index) {
  const SensorEchoes& echoes = file.contents.sensors.at(index);
  const WholeEchoFile::More& more = file.more.at(index);
  SensorDescription description;
  description.name = echoes.name;
  std::vector<BeamAxis> beams = beams_of(echoes, more);
  const bool across = are_across(beams);
  ReadRecording read;
  read.sensor =
      std::make_shared<PlainSensor>(std::move(description), number(more, "frequency_khz"), std::move(beams),
                                    samples_of(echoes, file.contents.file.string()), across);
  Recording& recording = read.recording;
  recording.sensor = read.sensor.get();
  recording.energy = echoes.energy;
  recording.ping_time_s = echoes.ping_time_s;
  recording.sound_speed_m_s = number(more, "sound_speed_m_s");
  recording.absorption_db_per_km = number(more, "absorption_db_per_km");
  recording.line_starts = line_starts(values(more, "line", {"ping"}, echoes.pings));
  recording.ping_numbers = consecutive(echoes.ping_number);
  const auto position = values(more, "sensor_position", {"ping", "xyz"}, 3 * echoes.pings),
             attitude = values(more, "sensor_attitude", {"ping", "wxyz"}, 4 * echoes.pings);
  for (std::size_t ping = 0; ping < echoes.pings; ++ping) {
    Pose pose;
    if (!position.empty())
      pose.position_m = {position[3 * ping], position[3 * ping + 1], position[3 * ping + 2]};
    if (const double* q = attitude.empty() ? nullptr : &attitude[4 * ping])
      pose.attitude = glm::dquat(q[0], q[1], q[2], q[3]);
    recording.ping_pose.push_back(pose);
    if (echoes.ping_time_s.empty()) recording.ping_time_s.push_back(static_cast<double>(ping));
  }
  return read;
}

ReadRecording picked(const Recording& all, const std::vector<std::size_t>& pings) {
  ReadRecording read;
  const Sensor& sensor = *all.sensor;
  read.sensor = std::make_shared<PlainSensor>(sensor.description(), sensor.frequency_khz(), sensor.beams(),
                                              sensor.samples(), sensor.is_across_track());
  Recording& recording = read.recording;
  recording.sensor = read.sensor.get();
  recording.sound_speed_m_s = all.sound_speed_m_s;
  recording.absorption_db_per_km = all.absorption_db_per_km;
  std::optional<std::size_t> line;
  std::vector<double> numbers;
  for (const std::size_t ping : pings) {
    numbers.push_back(all.number_of(ping));
    recording.ping_time_s.push_back(all.ping_time_s.at(ping));
    recording.ping_pose.push_back(all.ping_pose.at(ping));
    if (!all.altitude_m.empty()) recording.altitude_m.push_back(all.altitude_m.at(ping));
    if (!all.line_starts.empty() && line != all.line_of(ping).first) {
      line = all.line_of(ping).first;
      recording.line_starts.push_back(recording.ping_time_s.size() - 1);
    }
    const PingEnergies kept = all.energy_of(ping);
    const std::span<const double> energy = kept;
    read.energy.insert(read.energy.end(), energy.begin(), energy.end());
  }
  recording.energy = read.energy;
  recording.ping_numbers = consecutive(numbers);
  if (all.surfaces)
    recording.surfaces = [of = all.surfaces, pings](std::size_t ping) { return of(pings.at(ping)); };
  return read;
}

}  // namespace tubefoot
