// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/detection/receiver_pair_soundings.hpp"

#include <algorithm>
#include <cmath>

#include "sensors/model/angles.hpp"
#include "sensors/receiver/phase_noise.hpp"

namespace tubefoot {

ReceiverPairPing::ReceiverPairPing(const Recording& recording, std::size_t ping)
    : number_(recording.number_of(ping)),
      samples_(static_cast<std::size_t>(recording.sensor->samples().count)),
      channels_{recording.channel_of(ping, 0), recording.channel_of(ping, 1), recording.channel_of(ping, 2),
                recording.channel_of(ping, 3)} {}

InterferometricSample ReceiverPairPing::ideal(std::size_t beam, std::size_t sample) const {
  const std::size_t cell = beam * samples_ + sample;
  return {channels_[0][cell], channels_[1][cell], {channels_[2][cell], channels_[3][cell]}};
}

InterferometricSample ReceiverPairPing::received(std::size_t beam, std::size_t sample,
                                                 const InterferometricNoise& noise) const {
  InterferometricSample products = ideal(beam, sample);
  products.add_noise(noise.receiver_noise_j, noise.receiver_noise_j);
  if (!noise.phase_noise || !products.phase_rad()) return products;
  const SampleRandom random(noise.seed, number_, static_cast<std::uint32_t>(beam),
                            static_cast<std::uint32_t>(sample));
  products.cross_j *= std::polar(1.0, draw_phase_error(random, products.coherence()));
  return products;
}

std::vector<InterferometricSounding> interferometric_soundings(const Recording& recording, std::size_t ping,
                                                               const InterferometricNoise& noise,
                                                               const RunContext& run) {
  const Sensor& sensor = *recording.sensor;
  const Sensor::ReceiverPair& receiver_pair = sensor.receiver_pair();
  const SoundingPlacer placer(recording, run);
  const Pose& pose = recording.ping_pose[ping];
  const Interferometer interferometer(
      receiver_pair.baseline_m,
      placer.sound_speed_m_s(pose, recording.water_level_error_m(ping)) / (1000 * sensor.frequency_khz()),
      radians(receiver_pair.tilt_deg));
  const ReceiverPairPing of_ping(recording, ping);
  std::vector<InterferometricSounding> found;
  for (std::uint32_t beam = 0; beam < 2; ++beam) {
    std::optional<double> depth_m;
    if (ping < recording.altitude_m.size() && std::isfinite(recording.altitude_m[ping]))
      depth_m = recording.altitude_m[ping];
    for (std::uint32_t k = 0; k < static_cast<std::uint32_t>(sensor.samples().count); ++k) {
      InterferometricSounding sounding{beam, k};
      InterferometricSample products = of_ping.ideal(beam, k);
      sounding.energy_j = products.upper_j;
      products.add_noise(noise.receiver_noise_j, noise.receiver_noise_j);
      const std::optional<double> phase = products.phase_rad();
      if (!phase) continue;
      sounding.coherence = products.coherence();
      sounding.phase_rad = *phase;
      if (noise.phase_noise)
        sounding.phase_rad =
            wrapped(*phase + draw_phase_error(SampleRandom(noise.seed, recording.number_of(ping), beam, k),
                                              sounding.coherence));
      sounding.range_m = sensor.samples().first_m + (k + 0.5) * sensor.samples().step_m;
      if (!depth_m) depth_m = sounding.range_m;
      const double expected_rad = std::asin(std::clamp(*depth_m / sounding.range_m, -1.0, 1.0));
      const double angle = interferometer.angle_near(sounding.phase_rad, expected_rad);
      sounding.estimate =
          interferometer.point(sounding.range_m, angle, std::sqrt(phase_variance(sounding.coherence)));
      const double weight = 0.2 * sounding.coherence * sounding.coherence;
      *depth_m += weight * (sounding.estimate.depth_m - *depth_m);
      const double side = beam == 0 ? -1 : 1;
      const glm::dquat attitude = glm::normalize(pose.attitude);
      if (placer.traces_rays()) {
        sounding.position_m = placer.place(pose, {side * std::cos(angle), 0, -std::sin(angle)},
                                           sounding.range_m, recording.water_level_error_m(ping));
        const glm::dvec3 from_sensor = glm::inverse(attitude) * (sounding.position_m - pose.position_m);
        sounding.estimate.horizontal_m = side * from_sensor.x;
        sounding.estimate.depth_m = -from_sensor.z;
      } else {
        sounding.position_m = pose.position_m + attitude * glm::dvec3(side * sounding.estimate.horizontal_m,
                                                                      0, -sounding.estimate.depth_m);
      }
      found.push_back(sounding);
    }
  }
  return found;
}

}  // namespace tubefoot
