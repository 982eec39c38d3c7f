// SPDX-License-Identifier: GPL-3.0-or-later
#include "advice/trials.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <span>
#include <stdexcept>

#include "compare/echo_errors.hpp"
#include "engine/ground/ground.hpp"
#include "engine/rays/ray_engine.hpp"
#include "files/json_text.hpp"
#include "geometry/work/stop.hpp"
#include "run/abilities.hpp"
#include "run/simulation.hpp"

namespace tubefoot {
namespace {

EngineSetting tube(const std::string& engine, const std::string& setting) {
  EngineSetting s;
  s.engine = engine;
  s.setting = setting;
  s.run.engine = "tube";
  return s;
}

/// Only the chosen sensors and pings, each sensor for itself.
void trim(Survey& survey, const std::vector<TrialPings>& choice) {
  std::vector<SensorPings> kept;
  for (const TrialPings& chosen : choice) {
    SensorPings& all = survey.sensors[chosen.sensor];
    SensorPings some;
    for (const std::size_t ping : chosen.pings) {
      some.times_s.push_back(all.times_s[ping]);
      some.poses.push_back(all.poses[ping]);
      for (std::size_t shot = 0; shot < all.sensor->shots(); ++shot)
        some.shot_poses.push_back(all.shot_pose(ping, shot));
      for (std::size_t shot = 0; all.sensor->has_receiver_apart() && shot < all.sensor->shots(); ++shot)
        some.receiver_poses.push_back(all.receiver_pose(ping, shot));
    }
    some.sensor = std::move(all.sensor);
    kept.push_back(std::move(some));
  }
  survey.sensors = std::move(kept);
  survey.shots.clear();
  for (std::size_t s = 0; s < survey.sensors.size(); ++s) survey.shots.push_back(SharedShots{{s}});
}

std::vector<double> ranges_m(const RangeSamples& samples) {
  std::vector<double> ranges;
  for (int k = 0; k < samples.count; ++k) ranges.push_back(samples.first_m + (k + 0.5) * samples.step_m);
  return ranges;
}

std::string scene_name(const std::filesystem::path& scene) {
  const std::string stem = scene.stem().string();
  return text_of_name(stem == "scene" ? std::filesystem::absolute(scene).parent_path().filename().string()
                                      : stem);
}

}  // namespace

EngineSetting tube_setting(const std::string& binning) {
  EngineSetting s = tube(binning == "exact" ? "tubes, exact cuts" : "tubes, " + binning, "fixed");
  s.run.binning = binning;
  return s;
}

EngineSetting ray_setting(const std::string& sampling, std::int64_t rays_per_beam, std::size_t beams) {
  EngineSetting s;
  s.engine = sampling == "column" ? "rays, one column a beam" : "rays, " + sampling;
  s.setting = fmt::format("{} a beam", rays_per_beam);
  s.run.engine = "ray";
  s.run.sampling = sampling;
  s.run.rays_per_beam = rays_per_beam;
  s.rays = static_cast<double>(rays_per_beam) * static_cast<double>(beams);
  return s;
}

std::vector<EngineSetting> tube_settings() {
  std::vector<EngineSetting> all;
  for (const char* arithmetic : {"fixed", "filtered"}) {
    all.push_back(tube("tubes, exact cuts", arithmetic));
    all.back().run.arithmetic = arithmetic;
  }
  all.push_back(tube("tubes, double", "tolerance 0"));
  all.back().run.arithmetic = "double";
  all.push_back(tube("tubes, double", "tolerance 1e-14"));
  all.back().run.arithmetic = "double";
  all.back().run.zero_tolerance = 1e-14;
  for (const int split : {16, 256}) {
    all.push_back(tube("tubes, exact cuts", fmt::format("fixed, split above {}", split)));
    all.back().run.facets_per_split = split;
  }
  for (const char* binning : {"spread", "centroid"}) all.push_back(tube_setting(binning));
  return all;
}

std::vector<EngineSetting> ray_settings(std::size_t beams) {
  std::vector<EngineSetting> all;
  for (const char* sampling : {"stratified", "regular", "random", "column"})
    for (const std::int64_t rays : {1, 11, 23, 114, 400, 1500, 5000, 17000, 60000, 200000, 700000})
      all.push_back(ray_setting(sampling, rays, beams));
  return all;
}

TrialScene::Choice first_pings(std::size_t count) {
  return [count](const Survey& survey) {
    TrialPings chosen;
    for (std::size_t p = 0; p < std::min(count, survey.sensors.front().times_s.size()); ++p)
      chosen.pings.push_back(p);
    return std::vector{chosen};
  };
}

TrialScene::TrialScene(const SceneDescription& scene, const Choice& choice,
                       std::optional<double> reference_tolerance)
    : name_(scene_name(scene.file)), survey_((require_able(scene, Feature::trial), open_survey(scene))) {
  const std::vector<TrialPings> chosen = choice(*survey_);
  double all = 0;
  for (const TrialPings& c : chosen) {
    weight_.push_back(static_cast<double>(survey_->sensors[c.sensor].times_s.size()));
    all += weight_.back();
  }
  for (double& w : weight_) w /= all;
  trim(*survey_, chosen);
  survey_->scene.description.run = RunDescription{};
  SimulationStats stats;
  reference_ = simulate(*survey_, true, stats, reference_tolerance);
  for (const Recording& r : reference_) {
    const double total = std::accumulate(r.energy.begin(), r.energy.end(), 0.0);
    if (total > 0)
      bound_ = std::max(bound_, std::accumulate(r.energy_bound.begin(), r.energy_bound.end(), 0.0) / total);
  }
}

std::size_t TrialScene::beams() const {
  std::size_t most = 0;
  for (const SensorPings& s : survey_->sensors) most = std::max(most, s.sensor->beams().size());
  return most;
}

std::vector<std::string> TrialScene::silent_sensors() const {
  std::vector<std::string> names;
  for (const Recording& r : reference_)
    if (std::none_of(r.energy.begin(), r.energy.end(), [](double e) { return e > 0; }))
      names.push_back(r.sensor->description().name);
  return names;
}

std::string TrialScene::refusal_of(const EngineSetting& setting) {
  const auto why = refused(*survey_, setting.own ? std::vector{Feature::own_engine} : asked_by(setting.run));
  return why ? why->what : "";
}

std::vector<Recording> TrialScene::record(const EngineSetting& setting, double& seconds_a_ping) {
  survey_->scene.description.run = setting.run;
  survey_->own_engine = setting.own;
  if (setting.run.engine == "ray" && !survey_->rays && !survey_->ground)
    survey_->rays = std::make_shared<RayScene>(survey_->scene.mesh, survey_->scene.grid);
  // One sensor at a time, so that each one's seconds are known.
  std::vector<Recording> recordings;
  seconds_a_ping = 0;
  const std::vector<SharedShots> shots = std::move(survey_->shots);
  for (std::size_t s = 0; s < shots.size(); ++s) {
    survey_->shots.assign(1, shots[s]);
    SimulationStats stats;
    std::vector<Recording> all = simulate(*survey_, true, stats);
    seconds_a_ping +=
        weight_[s] * (stats.visibility_seconds + stats.echo_seconds) / static_cast<double>(stats.pings);
    recordings.push_back(std::move(all[s]));
  }
  survey_->shots = shots;
  return recordings;
}

Trial TrialScene::run(const EngineSetting& setting, int repeats) {
  std::vector<double> seconds(static_cast<std::size_t>(repeats));
  const std::vector<Recording> candidate = record(setting, seconds.front());
  for (std::size_t r = 1; r < seconds.size(); ++r) record(setting, seconds[r]);
  const auto middle = seconds.begin() + static_cast<std::ptrdiff_t>(seconds.size() / 2);
  std::nth_element(seconds.begin(), middle, seconds.end());
  Trial trial;
  trial.scene = name_;
  trial.engine = setting.engine;
  trial.setting = setting.setting;
  trial.seconds = *middle;
  trial.bound = bound_;
  trial.samples = setting.rays;
  trial.counts = setting.run.arithmetic != "double";
  for (std::size_t s = 0; s < candidate.size(); ++s) {
    const Recording& reference = reference_[s];
    const std::vector<double> ranges = ranges_m(reference.sensor->samples());
    const EchoShape ping{1, reference.sensor->beams().size(), ranges.size()};
    const EchoShape all{reference.ping_time_s.size(), ping.beams, ping.samples};
    const EchoErrors errors = echo_errors({all, reference.energy, candidate[s].energy, {}, ranges});
    trial.l1_error = std::max(trial.l1_error, errors.l1);
    trial.rms_db_error = std::max(trial.rms_db_error, errors.rms_db);
    std::vector<PingError>& pings = trial.pings.emplace_back();
    for (std::size_t p = 0; p < all.pings; ++p) {
      const auto part = [&](std::span<const double> energies) {
        return energies.subspan(p * ping.bins(), ping.bins());
      };
      const EchoErrors e = echo_errors({ping, part(reference.energy), part(candidate[s].energy), {}, ranges});
      const auto lit = static_cast<double>(e.lit_bins);
      pings.push_back({e.reference_total_j > 0 ? e.l1 * e.reference_total_j : e.candidate_total_j,
                       e.reference_total_j, e.rms_db * e.rms_db * lit, lit});
    }
  }
  return trial;
}

std::vector<EngineSetting> builtin_settings(std::size_t beams) {
  std::vector<EngineSetting> settings = tube_settings();
  for (EngineSetting& s : ray_settings(beams)) settings.push_back(std::move(s));
  return settings;
}

std::vector<Trial> all_trials(TrialScene& scene, const std::vector<EngineSetting>& settings, int repeats,
                              double seconds_per_trial, const std::function<void()>& step) {
  constexpr double next_rung = 5;  // rungs are about 4 apart
  constexpr double slow_seconds = 0.5;
  std::vector<Trial> trials;
  std::map<std::string, double> last_seconds;
  for (const EngineSetting& setting : settings) {
    stop_if_wanted();
    double& last = last_seconds[setting.engine];
    if (!scene.refusal_of(setting).empty()) {
      step();
      continue;
    }
    if (setting.rays == 0 || next_rung * last <= seconds_per_trial) {
      trials.push_back(scene.run(setting, last > slow_seconds ? 1 : repeats));
      last = trials.back().seconds;
    } else {
      last = seconds_per_trial;  // nor any finer one
    }
    step();
  }
  return trials;
}

}  // namespace tubefoot
