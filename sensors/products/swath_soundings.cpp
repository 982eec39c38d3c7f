// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/products/swath_soundings.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <utility>

#include "sensors/model/angles.hpp"
#include "sensors/products/noise_floor.hpp"

namespace tubefoot {
namespace {

std::vector<std::vector<double>> noise_floors_j(const Recording& recording, const RunContext& run) {
  std::vector<std::vector<double>> floors;
  for (std::size_t k = 0; k < recording.sectors(); ++k) floors.push_back(noise_floor_j(recording, run, k));
  return floors;
}

}  // namespace

BottomFinder::BottomFinder(const Recording& recording, const RunContext& run, const DetectionRule& rule)
    : BottomFinder(recording, ReceivedPings(recording, run),
                   recording.sensor->description().signal.tvg_spreading.has_value(), rule,
                   noise_floors_j(recording, run), SoundingPlacer(recording, run)) {}

BottomFinder BottomFinder::ideal(const Recording& recording, const DetectionRule& rule,
                                 const RunContext& run) {
  return BottomFinder(
      recording, ReceivedPings::ideal(recording), false, rule,
      std::vector(recording.sectors(),
                  std::vector<double>(static_cast<std::size_t>(recording.sensor->samples().count))),
      SoundingPlacer(recording, run));
}

BottomFinder::BottomFinder(const Recording& recording, ReceivedPings received, bool has_own_gain,
                           const DetectionRule& rule, std::vector<std::vector<double>> noise_floor_j,
                           SoundingPlacer placer)
    : recording_(recording),
      received_(std::move(received)),
      rule_(rule),
      floor_j_(std::move(noise_floor_j)),
      placer_(std::move(placer)) {
  const RangeSamples& samples = recording.sensor->samples();
  for (std::size_t sector = 0; sector < floor_j_.size(); ++sector) {
    gain_.emplace_back();
    for (int k = 0; k < samples.count; ++k) {
      const double range_m = samples.first_m + (k + 0.5) * samples.step_m;
      const double absorbed_db = 2 * recording.absorption_of(sector) * range_m / 1000;
      gain_.back().push_back(
          has_own_gain ? 1 : range_m * range_m * std::pow(10, std::fmin(absorbed_db, 1000) / 10));
    }
  }
}

SoundedPing BottomFinder::sound(std::size_t ping) const {
  const Sensor& sensor = *recording_.sensor;
  const RangeSamples& samples = sensor.samples();
  SoundedPing sounded;
  const PingEnergies energies = recording_.energy_of(ping);
  std::vector<double> evened(static_cast<std::size_t>(samples.count));
  for (std::size_t beam = 0; beam < sensor.beams().size(); ++beam) {
    sounded.received_j.push_back(received_.of_beam(ping, beam, energies));
    const std::vector<double>& received = sounded.received_j.back();
    std::fill(evened.begin(), evened.end(), 0.0);
    const std::size_t sector = recording_.sector_of(beam);
    for (std::size_t k = 0; k < received.size(); ++k)
      if (received[k] >= floor_j_[sector][k]) evened[k] = received[k] * gain_[sector][k];
    sounded.soundings.emplace_back();
    sounded.range_sigma_m.push_back(0);
    const std::optional<Detection> found = detect_bottom(evened, samples, rule_);
    const auto sample = static_cast<std::size_t>(found ? found->sample : samples.count / 2);
    const BeamRay& ray = sounded.rays.emplace_back(ray_of_beam(recording_, ping, beam, sample));
    if (!found || !ray.has_angle) continue;
    Sounding sounding;
    sounding.ping = recording_.number_of(ping);
    sounding.beam = static_cast<std::uint32_t>(beam);
    sounding.sector = static_cast<std::uint32_t>(sector);
    sounding.time_s = recording_.ping_time_s[ping];
    if (!sensor.transmit_sectors().empty())
      sounding.time_s += sensor.transmission_delay_s(sensor.first_transmission(sector));
    sounding.position_m = placer_.place(ray.pose, ray.axis, ray.range_from_pose_m(found->range_m),
                                        recording_.water_level_error_m(ping));
    sounding.two_way_travel_time_s = 2 * found->range_m / recording_.sound_speed_m_s;
    sounding.slant_range_m = found->range_m;
    sounding.beam_angle_deg = degrees(ray.across_rad);
    sounding.amplitude = receiver(beam).amplitude_upa(received[sample]);
    sounding.quality = found->quality;
    sounding.method = rule_.method;
    sounding.flags = found->flags;
    sounded.soundings.back() = sounding;
    sounded.range_sigma_m.back() = found->range_sigma_m;
  }
  return sounded;
}

}  // namespace tubefoot
