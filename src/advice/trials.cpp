// SPDX-License-Identifier: GPL-3.0-or-later
// Runs engine settings on chosen pings of a scene and measures their error against a reference and their
// work per ping.
#include "advice/trials.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <span>
#include <stdexcept>

#include "advice/work_meter.hpp"
#include "compare/measures/echo_errors.hpp"
#include "files/absolute_path.hpp"
#include "files/json_text.hpp"
#include "geometry/steps/stop.hpp"
#include "run/abilities.hpp"
#include "run/run_steps.hpp"
#include "run/settings.hpp"
#include "run/simulation.hpp"

namespace tubefoot {
namespace {

EngineSetting tube(const std::string& engine, const std::string& setting) {
  EngineSetting s;
  s.engine = engine;
  s.setting = setting;
  return s;
}

std::vector<double> ranges_m(const RangeSamples& samples) {
  std::vector<double> ranges;
  for (int k = 0; k < samples.count; ++k) ranges.push_back(samples.first_m + (k + 0.5) * samples.step_m);
  return ranges;
}

std::size_t receivers(const Recording& recording) { return recording.sensor->has_receiver_pair() ? 2 : 1; }

/// Returns the energies of the receivers, [ping][receiver][beam][sample]. Cross products of their signals
/// are omitted, because they have no level in dB. `values`: energies of the recording, or their bounds.
std::vector<double> received(const Recording& recording, std::span<const double> values) {
  if (values.empty()) return {};
  std::vector<double> all;
  for (std::size_t p = 0; p < recording.pings(); ++p) {
    const auto ping = values.subspan(p * recording.channels() * recording.cells(),
                                     receivers(recording) * recording.cells());
    all.insert(all.end(), ping.begin(), ping.end());
  }
  return all;
}

double sum(std::span<const double> values) { return std::accumulate(values.begin(), values.end(), 0.0); }

std::string scene_name(const std::filesystem::path& scene) {
  const std::string stem = scene.stem().string();
  return text_of_name(stem == "scene" ? absolute_path(scene).parent_path().filename().string() : stem);
}

}  // namespace

EngineSetting tube_setting(Binning binning) {
  EngineSetting s = tube(
      binning == Binning::exact ? "tubes, exact cuts" : fmt::format("tubes, {}", name_of(binning)), "fixed");
  s.run.binning = binning;
  return s;
}

EngineSetting ray_setting(RaySampling sampling, std::int64_t rays_per_beam, std::size_t beams) {
  EngineSetting s;
  s.engine = sampling == RaySampling::column ? "rays, one column per beam"
                                             : fmt::format("rays, {}", name_of(sampling));
  s.setting = fmt::format("{} per beam", rays_per_beam);
  s.run.engine = Engine::ray;
  s.run.rays.sampling = sampling;
  s.run.rays.rays = rays_per_beam;
  s.run.rays.per = RaySettings::Per::beam;
  s.rays = static_cast<double>(rays_per_beam) * static_cast<double>(beams);
  return s;
}

std::vector<EngineSetting> tube_settings() {
  std::vector<EngineSetting> all;
  for (const Arithmetic arithmetic : {Arithmetic::fixed, Arithmetic::filtered}) {
    all.push_back(tube("tubes, exact cuts", std::string(name_of(arithmetic))));
    all.back().run.visibility.arithmetic = arithmetic;
  }
  for (const double tolerance : {0.0, 1e-14}) {
    all.push_back(tube("tubes, double", fmt::format("tolerance {:g}", tolerance)));
    all.back().run.visibility.arithmetic = Arithmetic::plain_double;
    all.back().run.visibility.tolerance = tolerance;
  }
  for (const std::uint32_t split : {16u, 256u}) {
    all.push_back(tube("tubes, exact cuts", fmt::format("fixed, split above {}", split)));
    all.back().run.visibility.facets_per_split = split;
  }
  for (const Binning binning : {Binning::spread, Binning::centroid}) all.push_back(tube_setting(binning));
  return all;
}

std::vector<EngineSetting> ray_settings(std::size_t beams) {
  std::vector<EngineSetting> all;
  for (const RaySampling sampling : all_samplings)
    for (const std::int64_t rays : {1, 11, 23, 114, 400, 1500, 5000, 17000, 60000, 200000, 700000})
      all.push_back(ray_setting(sampling, rays, beams));
  return all;
}

TrialScene::Choice chosen_pings(const std::string& text) {
  return [text](const Survey& survey) {
    const PingRange range = resolved(text, survey.sensors.front().times_s.size());
    TrialPings chosen;
    for (std::int64_t p = range.first; p <= range.last; ++p)
      chosen.pings.push_back(static_cast<std::size_t>(p));
    return std::vector{chosen};
  };
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
    : name_(scene_name(scene.file)) {
  const std::unique_ptr<const Survey> survey = open_survey(scene, Facets::merged);
  const std::shared_ptr<const LoadedScene> given =
      survey->loaded_scene->facets_given > 0 ? open_survey(scene)->loaded_scene : nullptr;
  RunRequest request;
  request.reference_tolerance = reference_tolerance;
  double all = 0;
  for (const TrialPings& chosen : choice(*survey)) {
    weight_.push_back(static_cast<double>(survey->sensors[chosen.sensor].times_s.size()));
    all += weight_.back();
    const auto pings =
        std::make_shared<const SensorSet>(survey->sensor_set->some_pings(chosen.sensor, chosen.pings));
    surveys_.push_back({survey->loaded_scene, pings});
    if (given) as_given_.push_back({given, pings});
  }
  for (double& w : weight_) w /= all;
  PingWork ignored;
  reference_ = record(request, ignored);
  for (const Recording& r : reference_) {
    const double total = sum(received(r, r.energy));
    if (total > 0) bound_ = std::max(bound_, sum(received(r, r.energy_bound)) / total);
  }
}

std::size_t TrialScene::beams() const {
  std::size_t most = 0;
  for (const Survey& survey : surveys_) most = std::max(most, survey.sensors.front().sensor->beams().size());
  return most;
}

std::vector<std::string> TrialScene::silent_sensors() const {
  std::vector<std::string> names;
  for (const Recording& r : reference_)
    if (std::none_of(r.energy.begin(), r.energy.end(), [](double e) { return e > 0; }))
      names.push_back(r.sensor->description().name);
  return names;
}

std::string TrialScene::refusal_of(const EngineSetting& setting) const {
  for (const Survey& survey : surveys_)
    if (const auto why = refused(survey, requested_by(setting.run))) return why->what;
  return "";
}

const std::vector<Survey>& TrialScene::surveys_of(const RunRequest& request) const {
  return facets_for(request) == Facets::as_given && !as_given_.empty() ? as_given_ : surveys_;
}

std::vector<Recording> TrialScene::record(const RunRequest& request, PingWork& of_a_ping) const {
  // Computes one sensor and one ping at a time to measure the work of each.
  std::vector<Recording> recordings;
  of_a_ping = {};
  const std::vector<Survey>& surveys = surveys_of(request);
  for (std::size_t s = 0; s < surveys.size(); ++s) {
    const PingSimulation simulation(surveys[s], request);
    const StoreLayout layout = layout_of(surveys[s], request);
    const auto store = std::make_shared<PingStore>(layout);
    PingValues values;
    WorkMeter meter;
    for (std::size_t group = 0; group < layout.groups.size(); ++group)
      for (std::size_t ping = 0; ping < layout.groups[group].pings; ++ping) {
        stop_if_wanted();
        meter.start();
        const PingCounts counts = simulation.run({group, ping}, values);
        const PingWork work = meter.since_start();
        const double share = weight_[s] / static_cast<double>(layout.groups[group].pings);
        of_a_ping.seconds += share * work.seconds;
        of_a_ping.processor_seconds += share * work.processor_seconds;
        of_a_ping.instructions += share * work.instructions;
        store->finish(group, ping, counts, values);
      }
    recordings.push_back(std::move(recordings_of(surveys[s], store).front()));
  }
  return recordings;
}

Trial TrialScene::run(const EngineSetting& setting, int repeats) const {
  std::vector<PingWork> works(static_cast<std::size_t>(repeats));
  const std::vector<Recording> candidate = record(setting.run, works.front());
  for (std::size_t r = 1; r < works.size(); ++r) record(setting.run, works[r]);
  const auto median = [&works](double PingWork::*amount) {
    const auto middle = works.begin() + static_cast<std::ptrdiff_t>(works.size() / 2);
    std::nth_element(works.begin(), middle, works.end(),
                     [&](const PingWork& a, const PingWork& b) { return a.*amount < b.*amount; });
    return *middle.*amount;
  };
  Trial trial;
  trial.scene = name_;
  trial.engine = setting.engine;
  trial.setting = setting.setting;
  trial.work = {median(&PingWork::seconds), median(&PingWork::processor_seconds),
                median(&PingWork::instructions)};
  trial.bound = bound_;
  trial.samples = setting.rays;
  trial.counts = setting.run.visibility.arithmetic != Arithmetic::plain_double;
  for (std::size_t s = 0; s < candidate.size(); ++s) {
    const Recording& reference = reference_[s];
    const std::vector<double> ranges = ranges_m(reference.sensor->samples());
    const EchoShape ping{1, receivers(reference) * reference.sensor->beams().size(), ranges.size()};
    const EchoShape all{reference.ping_time_s.size(), ping.beams, ping.samples};
    const std::vector<double> sure = received(reference, reference.energy),
                              tried = received(candidate[s], candidate[s].energy);
    const EchoErrors errors = echo_errors({all, sure, tried, {}, ranges});
    trial.l1_error = std::max(trial.l1_error, errors.l1);
    trial.rms_db_error = std::max(trial.rms_db_error, errors.rms_db);
    std::vector<PingError>& pings = trial.pings.emplace_back();
    for (std::size_t p = 0; p < all.pings; ++p) {
      const auto part = [&](std::span<const double> energies) {
        return energies.subspan(p * ping.bins(), ping.bins());
      };
      const EchoErrors e = echo_errors({ping, part(sure), part(tried), {}, ranges});
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

std::vector<Trial> all_trials(const TrialScene& scene, const std::vector<EngineSetting>& settings,
                              int repeats, const LadderEnd& end, const std::function<void()>& step) {
  // The numbers of rays of consecutive settings differ by a factor of about 4.
  constexpr double next_rung = 5;
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
    if (setting.rays == 0 || (setting.rays <= end.rays && next_rung * last <= end.seconds)) {
      trials.push_back(scene.run(setting, last > slow_seconds ? 1 : repeats));
      last = trials.back().work.seconds;
    } else {
      last = end.seconds;  // skips finer settings too
    }
    step();
  }
  return trials;
}

}  // namespace tubefoot
