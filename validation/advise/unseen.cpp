// SPDX-License-Identifier: GPL-3.0-or-later
#include "unseen.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace tubefoot {
namespace {

std::vector<std::size_t> not_seen(const LookedAt& seen) {
  std::vector<std::size_t> rest;
  for (std::size_t p = 0; p < seen.pings; ++p)
    if (std::count(seen.probes.begin(), seen.probes.end(), p) +
            std::count(seen.others.begin(), seen.others.end(), p) ==
        0)
      rest.push_back(p);
  return rest;
}

std::vector<std::size_t> spread(const std::vector<std::size_t>& from, std::size_t count) {
  std::vector<std::size_t> some;
  for (const std::size_t k : looked_at(from.size(), count).probes) some.push_back(from[k]);
  return some;
}

SceneDescription moved(SceneDescription scene, int place) {
  for (SensorDescription& s : scene.sensors) {
    s.lever_arm_m[0] += 0.35 * (place - 1);
    s.lever_arm_m[1] += place % 2 == 0 ? 0.15 : -0.25;
    s.lever_arm_m[2] += 0.08 * (place + 1);
    s.yaw_deg += 1.5 * (place - 1) + 0.5;
  }
  return scene;
}

}  // namespace

UnseenPings::UnseenPings(const SceneDescription& scene, const std::vector<LookedAt>& seen,
                         std::size_t count) {
  std::vector<TrialPings> chosen;
  bool some_left_for_all = true;
  for (std::size_t s = 0; s < seen.size(); ++s) {
    std::vector<std::size_t> left = not_seen(seen[s]);
    some_left_for_all = some_left_for_all && !left.empty();
    if (left.empty())
      for (std::size_t p = 0; p < seen[s].pings; ++p) left.push_back(p);
    chosen.push_back({s, spread(left, count)});
  }
  const auto choice = [&](const Survey&) { return chosen; };
  if (some_left_for_all) {
    places_.push_back(std::make_unique<TrialScene>(scene, choice, std::nullopt));
    what_ = fmt::format("{} other pings", count);
    return;
  }
  for (int place = 0; place < moved_places; ++place)
    places_.push_back(std::make_unique<TrialScene>(moved(scene, place), choice, std::nullopt));
  what_ = fmt::format("{} other positions", moved_places);
}

Trial UnseenPings::run(EngineSetting setting, int repeats) {
  setting.run.rays.seed = 12345;
  Trial all;
  for (const auto& place : places_) {
    Trial trial = place->run(setting, repeats);
    trial.work.processor_seconds /= static_cast<double>(places_.size());
    if (all.pings.empty()) {
      all = std::move(trial);
      continue;
    }
    all.work.processor_seconds += trial.work.processor_seconds;
    for (std::size_t s = 0; s < all.pings.size(); ++s)
      all.pings[s].insert(all.pings[s].end(), trial.pings[s].begin(), trial.pings[s].end());
  }
  all.l1_error = all.rms_db_error = 0;
  for (const std::vector<PingError>& sensor : all.pings) {
    all.l1_error = std::max(all.l1_error, error_of(sensor, ErrorMeasure::l1));
    all.rms_db_error = std::max(all.rms_db_error, error_of(sensor, ErrorMeasure::rms_db));
  }
  return all;
}

std::vector<Measured> fine_ladder(UnseenPings& pings, RaySampling sampling, int repeats, double seconds,
                                  double most_rays) {
  constexpr double first = 32, step = 1.25;
  std::vector<Measured> ladder;
  for (double rays = first; rays <= most_rays; rays *= step) {
    EngineSetting setting = ray_setting(sampling, std::llround(rays), pings.beams());
    Trial trial = pings.run(setting, repeats);
    ladder.push_back({std::move(setting), std::move(trial)});
    if (ladder.back().trial.work.processor_seconds > seconds) break;
  }
  return ladder;
}

}  // namespace tubefoot
