// SPDX-License-Identifier: GPL-3.0-or-later
// Writes the files of the sensor kind "array" from the signals of a recording. Selects the possible
// products, and estimates their cost and memory.

#include "sensors/products/array_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <stdexcept>

#include "files/memory_at_hand.hpp"
#include "sensors/recordings/signal_recording.hpp"

namespace tubefoot {
namespace {

SignalCounts counts_of(const Recording& recording) {
  const SignalModel& model = *recording.sensor->signals();
  return {recording.pings(), model.array.receivers_m.size(), model.sampling.samples};
}

double bytes_of(const SignalCounts& counts) {
  return 16.0 * static_cast<double>(counts.pings) * static_cast<double>(counts.receivers) *
         static_cast<double>(counts.samples);
}

/// Positions of the elements on the vehicle. For a sensor that is turned towards a target they are on its
/// own axes.
ElementArray array_on_vehicle(const Sensor& sensor) {
  const SensorDescription& description = sensor.description();
  const ElementArray& own = sensor.signals()->array;
  const auto place_on = [&](const std::array<double, 3>& arm) {
    return description.look_at_m ? glm::dvec3(0) : glm::dvec3(arm[0], arm[1], arm[2]);
  };
  const glm::dvec3 transmitter_m = place_on(description.lever_arm_m),
                   receivers_m = place_on(description.receiver_arm_m.value_or(description.lever_arm_m));
  const glm::dquat mounting = sensor.mounting();
  ElementArray array;
  array.transmitter_m = transmitter_m + mounting * own.transmitter_m;
  for (const glm::dvec3 place : own.receivers_m) array.receivers_m.push_back(receivers_m + mounting * place);
  return array;
}

/// Removes products that are impossible with these numbers of pings, receivers and samples, and returns the
/// reasons.
std::vector<std::string> leave_out(SignalProducts& products, const Recording& recording) {
  const SignalModel& model = *recording.sensor->signals();
  const ElementArray array = array_on_vehicle(*recording.sensor);
  const SignalCounts counts = counts_of(recording);
  std::vector<std::string> why;
  if (products.interferogram)  // with fewer pings than looks_pings, a cell averages all of them
    products.interferogram->looks_pings = std::min(products.interferogram->looks_pings, counts.pings);
  const auto keep_if_made = [&](auto SignalProducts::*product, const char* name) {
    if (!(products.*product)) return;
    SignalProducts alone;
    alone.*product = products.*product;
    try {
      check(alone, array, counts);
      interpolator_for(model.waveform, model.sampling, products.interpolation_error)
          .check_holds(model.waveform, model.sampling);
    } catch (const std::invalid_argument& error) {
      why.push_back(fmt::format("'{}': tubefoot does not compute the {}: {}",
                                recording.sensor->description().name, name, error.what()));
      (products.*product).reset();
    }
  };
  keep_if_made(&SignalProducts::fan, "fan");
  keep_if_made(&SignalProducts::sidescan, "beams abeam");
  keep_if_made(&SignalProducts::multibeam, "soundings across the track");
  keep_if_made(&SignalProducts::aperture, "synthetic aperture");
  keep_if_made(&SignalProducts::interferogram, "interferogram");
  products.jsf = products.jsf && products.sidescan;
  products.sonar_netcdf = products.sonar_netcdf && fan_of_complex_beams(products) != nullptr;
  return why;
}

/// Checks the memory, because all pings of a recording are loaded while their files are written.
void require_memory_of(const SignalProducts& products, const Recording& recording, const RunContext& run) {
  const SignalCounts counts = counts_of(recording);
  const double arrays =
      (run.with_bounds ? 2 : 1) + (recording.signals ? double(recording.signals->derivatives.size()) : 0);
  require_memory(2 * arrays * bytes_of(counts) + memory_of_signal_files(products, counts),
                 recording.sensor->description().place,
                 fmt::format("the signal files of {} pings and {} receivers", counts.pings, counts.receivers),
                 "use fewer pings at a time (--pings), or leave out products");
}

bool has_assumed_configuration(const Recording& recording) {
  return !recording.recorded_poses.empty() || recording.assumed_sensor != nullptr ||
         recording.assumed_sound_speed_m_s > 0 || recording.steering_sound_speed_m_s > 0;
}

/// Track of the carrier that the software assumes, at the pings. If the sensor moves during reception, the
/// track continues after the last ping by the true motion.
std::vector<Trajectory::Sample> recorded_track(const Recording& recording, const Sensor& assumed) {
  const SignalModel& model = *recording.sensor->signals();
  const SensorDescription& description = assumed.description();
  const auto& arm = description.lever_arm_m;
  const glm::dquat from_mounting = glm::inverse(assumed.mounting());
  std::vector<Trajectory::Sample> track;
  for (std::size_t ping = 0; ping < recording.pings(); ++ping) {
    Pose pose = recording.recorded_pose(ping);
    if (!description.look_at_m) {
      pose.attitude = glm::normalize(pose.attitude * from_mounting);
      pose.position_m -= pose.attitude * glm::dvec3(arm[0], arm[1], arm[2]);
    }
    track.push_back({recording.ping_time_s[ping], pose});
  }
  if (model.stop_and_hop) return track;
  const Trajectory truth(recording.signals->track);
  const Pose last = track.back().pose, at_last = truth.at(track.back().time_s);
  const double end_s = track.back().time_s + model.sampling.end_s();
  const Pose at_end = truth.at(end_s);
  track.push_back({end_s,
                   {at_end.position_m + last.position_m - at_last.position_m,
                    glm::normalize(last.attitude * glm::inverse(at_last.attitude) * at_end.attitude)}});
  return track;
}

/// The signals with the geometry and the sound speed that the software assumes. It uses one sound speed for
/// steering and for ranges.
ElementSignals recorded_signals(const Recording& recording, ElementSignals signals) {
  const Sensor& assumed = recording.assumed_sensor ? *recording.assumed_sensor : *recording.sensor;
  signals.array = array_on_vehicle(assumed);
  signals.motion = VehicleMotion(recorded_track(recording, assumed), recording.ping_time_s,
                                 recording.sensor->signals()->stop_and_hop);
  if (recording.assumed_sound_speed_m_s > 0) signals.sound_speed_m_s = recording.assumed_sound_speed_m_s;
  // The assumed speed for steering takes precedence over that of the water.
  if (const double steering = recording.steering_sound_speed_m_s;
      steering > 0 && steering != recording.sound_speed_m_s)
    signals.sound_speed_m_s = steering;
  return signals;
}

}  // namespace

ElementSignals element_signals_of(const Recording& recording) {
  const Sensor& sensor = *recording.sensor;
  const SignalModel& model = *sensor.signals();
  const SignalRecording& recorded = *recording.signals;
  ElementSignals signals = silent_signals(
      array_on_vehicle(sensor), model.waveform, model.sampling,
      VehicleMotion(recorded.track, recording.ping_time_s, model.stop_and_hop), recording.sound_speed_m_s);
  const std::size_t values = 2 * signals.receivers() * signals.samples();
  const auto take = [&](const RecordedChannel& channel, std::vector<std::complex<double>>& all) {
    all.resize(signals.pressure.size());
    for (std::size_t ping = 0; ping < recording.pings(); ++ping) {
      stop_if_wanted();
      const PingEnergies from = channel.of(ping, values);
      for (std::size_t k = 0; k < values / 2; ++k)
        all[ping * values / 2 + k] = {from[2 * k], from[2 * k + 1]};
    }
  };
  take(recorded.pressure, signals.pressure);
  if (!recorded.bound.is_empty()) take(recorded.bound, signals.bound);
  for (const SignalRecording::Derivative& by : recorded.derivatives)
    take(by.channel, signals.derivatives.emplace_back(by.parameter, by.units, by.meaning).values);
  return signals;
}

std::vector<std::filesystem::path> write_array_files(const std::filesystem::path& folder,
                                                     const Recording& recording, const RunContext& run,
                                                     SignalProducts products,
                                                     std::vector<std::string>& warnings) {
  const SensorDescription& description = recording.sensor->description();
  if (!recording.signals) {
    warnings.push_back(fmt::format(
        "'{}': no signal files are written, because the phases of signals cannot be computed from energies",
        description.name));
    return {};
  }
  products = without_omitted(std::move(products), run.omitted);
  const std::vector<std::string> left_out = leave_out(products, recording);
  warnings.insert(warnings.end(), left_out.begin(), left_out.end());
  require_memory_of(products, recording, run);
  products.ping_numbers = recording.ping_numbers;
  try {
    const ElementSignals signals = element_signals_of(recording);
    if (!has_assumed_configuration(recording))
      return write_signal_files(folder, signals, products, run, warnings);
    const ElementSignals recorded = recorded_signals(recording, signals);
    return write_signal_files(folder, signals, products, run, warnings, &recorded);
  } catch (const std::invalid_argument& error) {
    throw InputError(description.place, fmt::format("sensor '{}': {}", description.name, error.what()));
  }
}

std::vector<std::string> array_files_left_out(const Recording& recording, const RunContext& run,
                                              SignalProducts products) {
  products = without_omitted(std::move(products), run.omitted);
  std::vector<std::string> why = leave_out(products, recording);
  require_memory_of(products, recording, run);
  return why;
}

WritingCost cost_of_array_files(const Recording& recording, const RunContext& run, SignalProducts products) {
  products = without_omitted(std::move(products), run.omitted);
  leave_out(products, recording);
  const SignalCounts counts = counts_of(recording);
  WritingCost cost = cost_of_signal_files(products, counts, run.pictures, run.omitted);
  if (run.with_bounds && run.writes("signals.nc")) cost.bytes += bytes_of(counts);  // bounds hardly compress
  return cost;
}

}  // namespace tubefoot
