// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "run/run_request.hpp"
#include "run/survey.hpp"
#include "scene/description/run_description.hpp"
#include "sensors/recordings/recording.hpp"
#include "study/work_precision.hpp"

namespace tubefoot {

/// One way to compute a scene.
struct EngineSetting {
  std::string engine, setting;  ///< for people: "rays, stratified", "114 a beam"
  RunRequest run;
  double rays = 0;  ///< a ping; 0 for tubes
};

/// The tube engine in fixed arithmetic with one of its binnings.
EngineSetting tube_setting(Binning binning);

/// The ray engine with one of its samplings, on `beams` beams.
EngineSetting ray_setting(RaySampling sampling, std::int64_t rays_per_beam, std::size_t beams);

/// Ways of the tube engine worth a chart: exact arithmetics, double, splitting, and the fast binnings.
std::vector<EngineSetting> tube_settings();

/// Ways of the ray engine on `beams` beams: each sampling on a ladder of rays a beam that goes through the
/// numbers that existing simulators use (1, 11, 23, 114, 1500, 17000).
std::vector<EngineSetting> ray_settings(std::size_t beams);

/// Pings of one sensor, by their numbers.
struct TrialPings {
  std::size_t sensor = 0;
  std::vector<std::size_t> pings;
};

/// Chosen pings of a loaded scene, with a reference to hold engines against.
class TrialScene {
 public:
  /// Pings of a survey to look at; may throw UsageError.
  using Choice = std::function<std::vector<TrialPings>(const Survey&)>;

  /// Loads the scene and computes the reference: certified to a tolerance, or without one just measured
  /// exactly, in double from the exact footprints on. Throws as open_survey() and simulate() do.
  TrialScene(const SceneDescription& scene, const Choice& choice, std::optional<double> reference_tolerance);

  const std::string& name() const { return name_; }
  /// Of the sensor with the most.
  std::size_t beams() const;
  /// Of the reference: sum of its half-widths over the sum of its energies, of the worst sensor.
  double bound() const { return bound_; }
  /// Sensors that receive nothing at all in the chosen pings: errors say nothing about them.
  std::vector<std::string> silent_sensors() const;

  /// Why a setting cannot compute this scene (abilities.hpp); empty if it can.
  std::string refusal_of(const EngineSetting& setting) const;
  /// Runs a setting `repeats` times. The first run's energies count, and the worst sensor's errors; the
  /// medians of the work, which is that of a ping, a sensor's weight being the pings it has in the scene.
  /// Work is that of the calling thread: where others help, in processor's seconds and instructions only its
  /// own.
  Trial run(const EngineSetting& setting, int repeats) const;

 private:
  std::vector<Recording> record(const RunRequest& request, PingWork& of_a_ping) const;
  const std::vector<Survey>& surveys_of(const RunRequest& request) const;

  std::string name_;
  std::vector<Survey> surveys_;   ///< of each chosen sensor's pings, on one site
  std::vector<Survey> as_given_;  ///< where that one's planes are merged: the same on one where they are not
  std::vector<double> weight_;    ///< by sensor: its share of the scene's pings
  std::vector<Recording> reference_;
  double bound_ = 0;
};

/// Every setting of both engines on `beams` beams.
std::vector<EngineSetting> builtin_settings(std::size_t beams);

/// Where a ladder of rays ends: before a rung that would probably take longer, which depends on the machine,
/// or that has more rays a ping, which does not.
struct LadderEnd {
  double seconds = std::numeric_limits<double>::infinity();
  double rays = std::numeric_limits<double>::infinity();
};

/// Settings on a scene, `step` called after each. What cannot compute it is left out, and so is what is
/// beyond the end; slow settings are run once instead of `repeats` times. Throws Interrupted when somebody
/// wants to stop.
std::vector<Trial> all_trials(
    const TrialScene& scene, const std::vector<EngineSetting>& settings, int repeats, const LadderEnd& end,
    const std::function<void()>& step = [] {});

/// The first pings of the first sensor.
TrialScene::Choice first_pings(std::size_t count);
/// Pings of the first sensor, as resolved() reads them.
TrialScene::Choice chosen_pings(const std::string& text);

}  // namespace tubefoot
