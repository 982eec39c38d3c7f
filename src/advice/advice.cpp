// SPDX-License-Identifier: GPL-3.0-or-later
// Finds the engine and the settings that satisfy an error tolerance with the least work. It measures tubes
// with each binning and rays with each sampling on probe pings, and predicts the error of all pings
// (docs/accuracy-and-speed.md).
#include "advice/advice.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "files/usage_error.hpp"
#include "geometry/steps/stop.hpp"
#include "run/console/progress.hpp"
#include "run/console/say.hpp"
#include "run/settings.hpp"
#include "study/ping_spread.hpp"

namespace tubefoot {
namespace {

constexpr int repeats = 3;

/// Steps of the number of rays per beam: the first number, the limits of the next factors, and the largest
/// number. `patient_rungs` is the number of steps after which rays that do not converge are given up.
constexpr double first_rays = 32, shortest_step = 1.25, longest_step = 4, most_rays = 1e9;
constexpr std::size_t patient_rungs = 4;

/// Factor on the number of rays that the fit predicts, because each further step costs time.
constexpr double surplus = 1.03;

/// The number of rays is small enough if the next smaller number that failed is within the factor
/// `fine_step`. It is also small enough if the error exceeds the fraction `fine_error` of the tolerance.
constexpr double fine_step = 1.1, fine_error = 0.95;
constexpr int most_refinements = 6;

/// Returns the seconds for `samples` samples, by a line through the last two steps.
double seconds_for(const std::vector<Trial>& ladder, double samples) {
  const Trial& last = ladder.back();
  const double in_proportion = last.work.processor_seconds * samples / last.samples;
  if (ladder.size() < 2) return in_proportion;
  const Trial& before = ladder[ladder.size() - 2];
  const double slope =
      (last.work.processor_seconds - before.work.processor_seconds) / (last.samples - before.samples);
  return slope > 0 ? last.work.processor_seconds + slope * (samples - last.samples) : in_proportion;
}

/// Runs settings on the probe pings and predicts errors and work of all other pings.
class Probes {
 public:
  Probes(const TrialScene& scene, const std::vector<LookedAt>& sensors, ErrorMeasure measure)
      : scene_(scene), sensors_(sensors), measure_(measure) {}

  /// Returns the trial of a setting and fills the errors and seconds of its candidate. The errors of the
  /// trial become the predicted ones.
  Trial run(const EngineSetting& setting, int times, Candidate& candidate) const {
    stop_if_wanted();
    candidate.setting = setting;
    Trial trial = scene_.run(setting, times);
    candidate.probe_error = error_of(trial, measure_);
    candidate.predicted_error = 0;
    for (std::size_t s = 0; s < sensors_.size(); ++s)
      candidate.predicted_error =
          std::max(candidate.predicted_error, error_limit(trial.pings[s], sensors_[s].pings, measure_));
    candidate.predicted_seconds = trial.work.processor_seconds;
    (measure_ == ErrorMeasure::l1 ? trial.l1_error : trial.rms_db_error) = candidate.predicted_error;
    return trial;
  }

  std::size_t beams() const { return scene_.beams(); }

  /// Returns a candidate with the reason if a setting cannot compute the scene.
  std::optional<Candidate> refused(const EngineSetting& setting) const {
    const std::string why = scene_.refusal_of(setting);
    if (why.empty()) return std::nullopt;
    Candidate candidate;
    candidate.setting = setting;
    candidate.tried = false;
    candidate.note = why;
    return candidate;
  }

 private:
  const TrialScene& scene_;
  const std::vector<LookedAt>& sensors_;
  ErrorMeasure measure_;
};

/// Finds the smallest number of rays with which a sampling is predicted to satisfy the tolerance, on the
/// probe pings.
class RayLadder {
 public:
  RayLadder(const Probes& probes, RaySampling sampling, const Tolerance& tolerance, std::uint64_t seed,
            double seconds_cap)
      : probes_(probes),
        sampling_(sampling),
        measure_(tolerance.measure),
        target_(tolerance.value),
        seed_(seed),
        cap_(seconds_cap),
        beams_(static_cast<double>(probes.beams())) {}

  Candidate climb() {
    double rays = first_rays;
    while (!step(rays)) {
      const double needed = samples_for(ladder_, measure_, target_).value_or(0) / beams_;
      if (needed <= 0 && ladder_.size() >= patient_rungs)
        return not_tried(rays, fmt::format("does not converge: {} at {:.0f} rays per beam",
                                           error_text(measure_, error()), rays));
      const double next = needed > 0 ? std::clamp(surplus * needed, shortest_step * rays, longest_step * rays)
                                     : longest_step * rays;
      if (const double seconds = seconds_for(ladder_, next * beams_); seconds > cap_ || next > most_rays) {
        if (needed > 0)
          return not_tried(std::max(needed, next),
                           fmt::format("would need about {:.1e} rays per beam", std::max(needed, next)));
        return not_tried(rays, fmt::format("far above the tolerance at {:.0f} rays per beam: {}", rays,
                                           error_text(measure_, error())));
      }
      rays = std::round(next);
    }
    return refined();
  }

 private:
  /// Runs one step and returns whether its error satisfies the tolerance.
  bool step(double rays) {
    ladder_.push_back(probes_.run(setting(rays), 1, last_));
    return error() <= target_;
  }

  double error() const { return error_of(ladder_.back(), measure_); }

  EngineSetting setting(double rays) const {
    EngineSetting s = ray_setting(sampling_, static_cast<std::int64_t>(rays), probes_.beams());
    s.run.rays.seed = seed_;
    return s;
  }

  /// Narrows down the number of rays between the last step, which satisfies the tolerance, and the one
  /// before, which does not.
  Candidate refined() {
    Trial good = ladder_.back();
    if (ladder_.size() > 1) {
      Trial bad = ladder_[ladder_.size() - 2];
      for (int k = 0; k < most_refinements; ++k) {
        const double least = error_of(good, measure_), most = error_of(bad, measure_);
        if (good.samples < fine_step * bad.samples || least > fine_error * target_) break;
        const double part =
            least > 0 && std::isfinite(most) ? std::log(most / target_) / std::log(most / least) : 0.5;
        const double nearest = std::sqrt(fine_step);
        const double samples = std::clamp(surplus * bad.samples * std::pow(good.samples / bad.samples, part),
                                          nearest * bad.samples, good.samples / nearest);
        const double rays = std::round(samples / beams_);
        if (rays * beams_ <= bad.samples || rays * beams_ >= good.samples) break;
        const bool holds = step(rays);  // called first, because it appends to ladder_
        (holds ? good : bad) = ladder_.back();
      }
    }
    Candidate candidate;
    probes_.run(setting(std::round(good.samples / beams_)), repeats, candidate);
    return candidate;
  }

  Candidate not_tried(double rays, std::string why) const {
    Candidate candidate = last_;
    candidate.setting = setting(std::min(rays, most_rays));
    if (const double samples = rays * beams_; samples > ladder_.back().samples) {
      candidate.probe_error = candidate.predicted_error = target_;
      candidate.predicted_seconds = seconds_for(ladder_, samples);
    }
    candidate.tried = false;
    candidate.note = std::move(why);
    return candidate;
  }

  const Probes& probes_;
  RaySampling sampling_;
  ErrorMeasure measure_;
  double target_;
  std::uint64_t seed_;
  double cap_, beams_;
  std::vector<Trial> ladder_;  ///< with predicted errors
  Candidate last_;             ///< the last step
};

std::vector<TrialPings> pings_of(const std::vector<LookedAt>& sensors, bool probes) {
  std::vector<TrialPings> chosen;
  for (std::size_t s = 0; s < sensors.size(); ++s)
    chosen.push_back({s, probes ? sensors[s].probes : sensors[s].others});
  return chosen;
}

/// Measures the candidates on other pings and with another seed of rays. If a sensor has no other pings,
/// only the seed differs.
void measure_on_others(Advice& advice, const SceneDescription& scene, std::uint64_t seed) {
  TrialScene others(
      scene, [&](const Survey&) { return pings_of(advice.sensors, false); }, std::nullopt);
  const ThreadLimit one_thread(1);
  for (Candidate& candidate : advice.candidates) {
    if (!candidate.tried) continue;
    stop_if_wanted();
    EngineSetting setting = candidate.setting;
    setting.run.rays.seed = seed;
    candidate.others = others.run(setting, repeats);
  }
}

}  // namespace

bool Advice::holds(const Candidate& candidate) const {
  return candidate.tried && candidate.predicted_error <= tolerance.value &&
         (!candidate.others || error_of(*candidate.others, tolerance.measure) <= tolerance.value);
}

double Advice::seconds(const Candidate& candidate) const {
  return candidate.others ? candidate.others->work.processor_seconds : candidate.predicted_seconds;
}

std::size_t cheapest(const Advice& advice) {
  std::size_t best = 0;
  for (std::size_t c = 1; c < advice.candidates.size(); ++c)
    if (advice.holds(advice.candidates[c]) &&
        advice.seconds(advice.candidates[c]) < advice.seconds(advice.candidates[best]))
      best = c;
  return best;
}

LookedAt looked_at(std::size_t pings, std::size_t count) {
  const auto spread_over = [](const std::vector<std::size_t>& from, std::size_t wanted) {
    const std::size_t n = std::min(wanted, from.size());
    std::vector<std::size_t> some;
    for (std::size_t i = 0; i < n; ++i) some.push_back(from[(2 * i + 1) * from.size() / (2 * n)]);
    return some;
  };
  std::vector<std::size_t> all(pings);
  for (std::size_t p = 0; p < pings; ++p) all[p] = p;
  LookedAt sensor;
  sensor.pings = pings;
  // Probes and others alternate, so that the others are as far from the probes as possible.
  if (2 * count <= pings) {
    const std::vector<std::size_t> both = spread_over(all, 2 * count);
    for (std::size_t k = 0; k < both.size(); ++k)
      (k % 2 == 0 ? sensor.probes : sensor.others).push_back(both[k]);
    return sensor;
  }
  sensor.probes = spread_over(all, count);
  std::vector<std::size_t> rest;
  std::set_difference(all.begin(), all.end(), sensor.probes.begin(), sensor.probes.end(),
                      std::back_inserter(rest));
  sensor.others_are_probes = rest.empty();
  sensor.others = rest.empty() ? sensor.probes : spread_over(rest, count);
  return sensor;
}

Advice advise(const SceneDescription& scene, const Tolerance& tolerance, const AdviceOptions& options) {
  Advice advice;
  advice.tolerance = tolerance;
  {
    TrialScene probe_pings(
        scene,
        [&](const Survey& survey) {
          for (const SensorPings& s : survey.sensors) {
            const std::string& name = s.sensor->description().name;
            const PingRange range = resolved(options.pings, s.times_s.size(), name);
            LookedAt sensor =
                looked_at(static_cast<std::size_t>(range.last - range.first + 1), options.trial_pings);
            for (std::vector<std::size_t>* pings : {&sensor.probes, &sensor.others})
              for (std::size_t& ping : *pings) ping += static_cast<std::size_t>(range.first);
            sensor.sensor = name;
            advice.sensors.push_back(std::move(sensor));
          }
          return pings_of(advice.sensors, true);
        },
        std::nullopt);
    const ThreadLimit one_thread(1);  // the seconds of a setting are those of one thread
    advice.silent = probe_pings.silent_sensors();
    const Probes probes(probe_pings, advice.sensors, tolerance.measure);
    constexpr std::array binnings{Binning::exact, Binning::spread, Binning::centroid};
    const bool choice = advice.silent.empty();
    Progress progress("settings", choice ? binnings.size() + options.samplings.size() : 1, options.quiet);
    for (const Binning binning : binnings) {
      if (const auto refused = probes.refused(tube_setting(binning)))
        advice.candidates.push_back(*refused);
      else
        probes.run(tube_setting(binning), repeats, advice.candidates.emplace_back());
      progress.step();
      if (!choice) break;
    }
    const double cap = options.largest_cost * advice.candidates.front().predicted_seconds;
    for (const RaySampling sampling : options.samplings) {
      if (!choice) break;
      if (const auto refused = probes.refused(ray_setting(sampling, 1, probes.beams())))
        advice.candidates.push_back(*refused);
      else
        advice.candidates.push_back(RayLadder(probes, sampling, tolerance, options.seed, cap).climb());
      progress.step();
    }
  }
  if (options.measure) measure_on_others(advice, scene, options.seed + 1);
  advice.chosen = cheapest(advice);
  return advice;
}

std::string left_out_by(const RunRequest& run) {
  if (run.engine == Engine::ray) return "surfaces between rays";
  if (run.binning == Binning::spread)
    return "borders of range bins inside footprints (the energy of a footprint is computed at its centroid "
           "and spread uniformly over its slant ranges)";
  if (run.binning == Binning::centroid)
    return "borders of range bins inside footprints (the whole energy of a footprint is assigned to the "
           "range bin of its centroid)";
  return "nothing";
}

std::string command_options(const RunRequest& run) {
  if (run.engine == Engine::ray)
    return fmt::format("--engine ray --sampling {} --rays-per-beam {}", name_of(run.rays.sampling),
                       run.rays.rays);
  return fmt::format("--engine tube --arithmetic {} --binning {}", name_of(run.visibility.arithmetic),
                     name_of(run.binning));
}

Advice pick_settings(const SceneDescription& description, RunRequest& request, bool quiet) {
  AdviceOptions options;
  options.measure = false;   // the user waits for the result
  options.largest_cost = 1;  // rays that need more work would not be selected
  options.seed = request.rays.seed;
  options.quiet = quiet;
  Advice advice = advise(description, *request.tolerance, options);
  const EngineSetting& chosen = advice.best().setting;
  request.engine = chosen.run.engine;
  request.visibility = chosen.run.visibility;
  request.binning = chosen.run.binning;
  if (request.engine == Engine::ray) {
    request.rays = chosen.run.rays;
    request.rays.seed = options.seed;
  }
  if (!quiet) say("for {}: {}, {}\n", to_text(*request.tolerance), chosen.engine, chosen.setting);
  return advice;
}

std::string pings_text(const std::string& sensor, const std::vector<std::size_t>& pings, std::size_t all) {
  return fmt::format("{}: ping{} {} of {}", sensor, pings.size() == 1 ? "" : "s", fmt::join(pings, ", "),
                     all);
}

}  // namespace tubefoot
