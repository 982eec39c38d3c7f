// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/trials.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "app/simulation.hpp"
#include "compare/echo_errors.hpp"

namespace tubefoot {
namespace {

EngineSetting tube(const std::string& engine, const std::string& setting) {
  EngineSetting s;
  s.engine = engine;
  s.setting = setting;
  s.run.engine = "tube";
  return s;
}

/// Only the first sensor and its first pings.
void trim(Survey& survey, std::size_t pings) {
  survey.sensors.resize(1);
  SensorPings& sensor = survey.sensors.front();
  sensor.times_s.resize(std::min(pings, sensor.times_s.size()));
  sensor.poses.resize(sensor.times_s.size());
  survey.shots.assign(1, SharedShots{{0}});
}

std::string scene_name(const std::filesystem::path& scene) {
  const std::string stem = scene.stem().string();
  return stem == "scene" ? std::filesystem::absolute(scene).parent_path().filename().string() : stem;
}

}  // namespace

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
  for (const char* binning : {"spread", "centroid"}) {
    all.push_back(tube(fmt::format("tubes, {}", binning), "fixed"));
    all.back().run.binning = binning;
  }
  return all;
}

std::vector<EngineSetting> ray_settings(std::size_t beams) {
  std::vector<EngineSetting> all;
  for (const char* sampling : {"stratified", "regular", "random", "column"})
    for (const std::int64_t rays : {1, 11, 23, 114, 400, 1500, 5000, 17000, 60000, 200000, 700000}) {
      EngineSetting s;
      s.engine = sampling == std::string_view("column") ? "rays, one column a beam"
                                                        : fmt::format("rays, {}", sampling);
      s.setting = fmt::format("{} a beam", rays);
      s.run.engine = "ray";
      s.run.sampling = sampling;
      s.run.rays_per_beam = rays;
      s.rays = static_cast<double>(rays) * static_cast<double>(beams);
      all.push_back(std::move(s));
    }
  return all;
}

TrialScene::TrialScene(const std::filesystem::path& scene, std::size_t pings, double reference_tolerance)
    : name_(scene_name(scene)), survey_(open_survey(read_scene_file(scene))) {
  trim(*survey_, pings);
  survey_->scene.description.run = RunDescription{};
  SimulationStats stats;
  const Recording recording = std::move(simulate(*survey_, true, stats, reference_tolerance).front());
  reference_ = recording.energy;
  reference_bound_ = recording.energy_bound;
  const RangeSamples& samples = survey_->sensors.front().sensor->samples();
  for (int k = 0; k < samples.count; ++k) ranges_m_.push_back(samples.first_m + (k + 0.5) * samples.step_m);
  const double total = std::accumulate(reference_.begin(), reference_.end(), 0.0);
  if (total > 0) bound_ = std::accumulate(reference_bound_.begin(), reference_bound_.end(), 0.0) / total;
}

std::vector<double> TrialScene::energies(const EngineSetting& setting, double& seconds_a_ping) {
  survey_->scene.description.run = setting.run;
  SimulationStats stats;
  std::vector<Recording> recordings = simulate(*survey_, true, stats);
  seconds_a_ping = (stats.visibility_seconds + stats.echo_seconds) / static_cast<double>(stats.pings);
  return std::move(recordings.front().energy);
}

double TrialScene::seconds(const EngineSetting& setting) {
  double seconds = 0;
  energies(setting, seconds);
  return seconds;
}

Trial TrialScene::run(const EngineSetting& setting, int repeats) {
  std::vector<double> seconds(1);
  const std::vector<double> candidate = energies(setting, seconds.front());
  for (int r = 1; r < repeats; ++r) seconds.push_back(this->seconds(setting));
  std::nth_element(seconds.begin(), seconds.begin() + static_cast<std::ptrdiff_t>(seconds.size() / 2),
                   seconds.end());
  const EchoShape shape{survey_->sensors.front().times_s.size(), beams(), ranges_m_.size()};
  const EchoErrors errors = echo_errors({shape, reference_, candidate, reference_bound_, ranges_m_});
  Trial trial;
  trial.scene = name_;
  trial.engine = setting.engine;
  trial.setting = setting.setting;
  trial.l1_error = errors.l1;
  trial.rms_db_error = errors.rms_db;
  trial.seconds = seconds[seconds.size() / 2];
  trial.bound = bound_;
  trial.samples = setting.rays;
  return trial;
}

}  // namespace tubefoot
