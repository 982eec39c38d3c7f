// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/products/swath_soundings.hpp"

#include <cmath>
#include <numbers>

#include "sensors/model/angles.hpp"
#include "sensors/products/noise_floor.hpp"
#include "sensors/receiver/pulse.hpp"

namespace tubefoot {
namespace {

constexpr double straight_down_rad = std::numbers::pi / 2;

}  // namespace

double across_angle_rad(const BeamAxis& axis) {
  return std::copysign(straight_down_rad + axis.elevation_rad, axis.azimuth_rad);
}

glm::dvec3 across_direction(double across_angle_rad) {
  return std::sin(across_angle_rad) * starboard_axis - std::cos(across_angle_rad) * up_axis;
}

BottomFinder::BottomFinder(const Recording& recording, const RunContext& run, const DetectionRule& rule)
    : BottomFinder(recording, receiver_of(recording, run), recording.sensor->description().signal, rule,
                   noise_floor_j(recording, run)) {}

BottomFinder BottomFinder::ideal(const Recording& recording, const DetectionRule& rule) {
  return BottomFinder(recording, ReceiverChain({}), {}, rule,
                      std::vector<double>(static_cast<std::size_t>(recording.sensor->samples().count)));
}

BottomFinder::BottomFinder(const Recording& recording, const ReceiverChain& receiver,
                           const SignalDescription& signal, const DetectionRule& rule,
                           std::vector<double> noise_floor_j)
    : recording_(recording),
      receiver_(receiver),
      pulse_extent_m_(
          signal.pulse_length_us ? pulse_extent_m(*signal.pulse_length_us, recording.sound_speed_m_s) : 0),
      rule_(rule),
      floor_j_(std::move(noise_floor_j)) {
  const RangeSamples& samples = recording.sensor->samples();
  for (int k = 0; k < samples.count; ++k) {
    const double range_m = samples.first_m + (k + 0.5) * samples.step_m;
    const double absorbed_db = 2 * recording.absorption_db_per_km * range_m / 1000;
    gain_.push_back(
        signal.tvg_spreading ? 1 : range_m * range_m * std::pow(10, std::fmin(absorbed_db, 1000) / 10));
  }
}

SoundedPing BottomFinder::sound(std::size_t ping) const {
  const Sensor& sensor = *recording_.sensor;
  const RangeSamples& samples = sensor.samples();
  const auto count = static_cast<std::size_t>(samples.count);
  SoundedPing sounded;
  const PingEnergies kept = recording_.energy_of(ping);
  const std::span<const double> energy = kept;
  const std::uint32_t number = recording_.number_of(ping);
  sounded.received_j =
      pulse_extent_m_ > 0
          ? receiver_.receive(number, spread_over_pulse(energy, samples, pulse_extent_m_), samples)
          : receiver_.receive(number, energy, samples);
  std::vector<double> evened(count);
  for (std::size_t beam = 0; beam < sensor.beams().size(); ++beam) {
    const double* received = sounded.received_j.data() + beam * count;
    for (std::size_t k = 0; k < count; ++k)
      evened[k] = received[k] < floor_j_[k] ? 0 : received[k] * gain_[k];
    sounded.soundings.emplace_back();
    sounded.range_sigma_m.push_back(0);
    const std::optional<Detection> found = detect_bottom(evened, samples, rule_);
    if (!found) continue;
    const double angle_rad = across_angle_rad(sensor.beams()[beam]);
    Sounding sounding;
    sounding.ping = number;
    sounding.beam = static_cast<std::uint32_t>(beam);
    sounding.time_s = recording_.ping_time_s[ping];
    sounding.position_m =
        sounding_position(recording_.ping_pose[ping], across_direction(angle_rad), found->range_m);
    sounding.two_way_travel_time_s = 2 * found->range_m / recording_.sound_speed_m_s;
    sounding.slant_range_m = found->range_m;
    sounding.beam_angle_deg = degrees(angle_rad);
    sounding.amplitude = receiver_.amplitude_upa(received[found->sample]);
    sounding.quality = found->quality;
    sounding.method = rule_.method;
    sounding.flags = found->flags;
    sounded.soundings.back() = sounding;
    sounded.range_sigma_m.back() = found->range_sigma_m;
  }
  return sounded;
}

}  // namespace tubefoot
