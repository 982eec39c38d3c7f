// SPDX-License-Identifier: GPL-3.0-or-later
#include "compare/attribution/scene_at_hand.hpp"

#include <fmt/format.h>

#include <cmath>

#include "files/input_error.hpp"

namespace tubefoot {
namespace {

/// Takes the numbers that a file lists, or 0, 1, 2 and so on. Returns false unless all are below `count`.
template <class Number>
bool take_numbers(const std::vector<double>& given, std::size_t found, std::size_t count,
                  std::vector<Number>& numbers) {
  if (given.empty() && found != count) return false;
  for (std::size_t k = 0; k < found; ++k) {
    const double number = given.empty() ? double(k) : given.at(k);
    if (!(number >= 0 && number < double(count))) return false;
    numbers.push_back(static_cast<Number>(number));
  }
  return true;
}

}  // namespace

SceneAtHand::SceneAtHand(const SceneDescription& scene, const EchoContents& reference, bool any_scene,
                         std::vector<std::string>& notes)
    : scene_(scene.file.string()),
      reference_(reference.file.string()),
      one_sensor_(reference.sensors.size() == 1) {
  const std::string& hash = reference.provenance.scene_hash;
  if (hash.empty()) {
    notes.push_back(
        fmt::format("the reference has no scene_hash, so it is unknown whether it belongs to '{}'", scene_));
  } else if (hash != scene.sha256) {
    if (!any_scene)
      throw InputError({reference_},
                       fmt::format("scene_hash is {}, but '{}' has {}: name the scene of the reference with "
                                   "--scene, or use this scene nevertheless with --any-scene",
                                   hash, scene_, scene.sha256));
    notes.push_back(
        fmt::format("the reference belongs to another version of '{}' (scene_hash {})", scene_, hash));
  }
  survey_ = open_survey(scene);
}

SensorPlace SceneAtHand::place_of(const SensorEchoes& echoes) const {
  const auto& sensors = survey_->sensors;
  SensorPlace place{sensors.size(), {}, {}};
  for (std::size_t s = 0; s < sensors.size(); ++s)
    if (sensors[s].sensor->description().name == echoes.name) place.sensor = s;
  if (place.sensor == sensors.size() && one_sensor_ && sensors.size() == 1) place.sensor = 0;
  const auto fail = [&](const std::string& words) {
    throw InputError({reference_}, fmt::format("sensor '{}' {}: name the scene of the reference with --scene",
                                               echoes.name, words));
  };
  if (place.sensor == sensors.size()) fail(fmt::format("is not in '{}'", scene_));
  const SensorPings& pings = sensors[place.sensor];
  const Sensor& sensor = *pings.sensor;
  const RangeSamples& samples = sensor.samples();
  if (!take_numbers(echoes.ping_number, echoes.pings, pings.times_s.size(), place.pings) ||
      !take_numbers(echoes.beam_number, echoes.beams, sensor.beams().size(), place.beams) ||
      echoes.samples != static_cast<std::size_t>(samples.count))
    fail(fmt::format("has {} pings x {} beams x {} range bins, but in '{}' it has {} x {} x {}", echoes.pings,
                     echoes.beams, echoes.samples, scene_, pings.times_s.size(), sensor.beams().size(),
                     samples.count));
  constexpr double part_of_sample = 0.01;
  for (const std::size_t k : {std::size_t{0}, echoes.samples - 1}) {
    const double middle_m = samples.first_m + (double(k) + 0.5) * samples.step_m;
    if (!(std::abs(echoes.slant_range_m.at(k) - middle_m) <= part_of_sample * samples.step_m))
      fail(fmt::format("has slant range {} m at range bin {}, but in '{}' it has {} m",
                       echoes.slant_range_m[k], k, scene_, middle_m));
  }
  return place;
}

}  // namespace tubefoot
