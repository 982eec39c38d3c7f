// SPDX-License-Identifier: GPL-3.0-or-later
// Runs engine settings on chosen pings of a scene and measures their errors and work. A reference is computed
// for the same pings.
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
  std::string engine, setting;  ///< names for the user, for example "rays, stratified" and "114 per beam"
  RunRequest run;
  double rays = 0;  ///< rays per ping; 0 for tubes
};

/// Returns the tube engine in fixed-point arithmetic with one of its binnings.
EngineSetting tube_setting(Binning binning);

/// Returns the ray engine with one of its samplings, for `beams` beams.
EngineSetting ray_setting(RaySampling sampling, std::int64_t rays_per_beam, std::size_t beams);

/// Returns the settings of the tube engine for a chart: exact arithmetics, double, splitting, and the fast
/// binnings.
std::vector<EngineSetting> tube_settings();

/// Returns the settings of the ray engine for `beams` beams: each sampling with increasing numbers of rays
/// per beam. They include the numbers of existing simulators (1, 11, 23, 114, 1500, 17000).
std::vector<EngineSetting> ray_settings(std::size_t beams);

/// Selected pings of one sensor, by their numbers.
struct TrialPings {
  std::size_t sensor = 0;
  std::vector<std::size_t> pings;
};

/// Selected pings of a loaded scene, with a reference with which engines are compared.
class TrialScene {
 public:
  /// Selects the pings of a survey; may throw UsageError.
  using Choice = std::function<std::vector<TrialPings>(const Survey&)>;

  /// Loads the scene and computes the reference. With a tolerance the reference is certified. Without one
  /// it is computed from the exact footprints in double, without bounds. Throws as open_survey() and
  /// simulate() do.
  TrialScene(const SceneDescription& scene, const Choice& choice, std::optional<double> reference_tolerance);

  const std::string& name() const { return name_; }
  /// Returns the largest number of beams of a sensor.
  std::size_t beams() const;
  /// Returns the relative bound of the reference: sum of half-widths / sum of energies, for the worst
  /// sensor.
  double bound() const { return bound_; }
  /// Returns the sensors without any echo in the selected pings. Errors are meaningless for them.
  std::vector<std::string> silent_sensors() const;

  /// Returns the reason why a setting cannot compute the scene (abilities.hpp); empty if it can.
  std::string refusal_of(const EngineSetting& setting) const;
  /// Runs a setting `repeats` times.
  ///
  /// The energies are those of the first run, and the errors are those of the worst sensor. The work is the
  /// median over the runs, per ping, and sensors are weighted with their number of pings in the scene. It
  /// is the work of the calling thread. If other threads take part, processor seconds and instructions
  /// count only the calling thread.
  Trial run(const EngineSetting& setting, int repeats) const;

 private:
  std::vector<Recording> record(const RunRequest& request, PingWork& of_a_ping) const;
  const std::vector<Survey>& surveys_of(const RunRequest& request) const;

  std::string name_;
  std::vector<Survey> surveys_;  ///< pings of each selected sensor, on one loaded scene
  /// The same pings on a scene without merged planes, if the scene merges planes.
  std::vector<Survey> as_given_;
  std::vector<double> weight_;  ///< by sensor: its share of the pings of the scene
  std::vector<Recording> reference_;
  double bound_ = 0;
};

/// Returns every setting of both engines for `beams` beams.
std::vector<EngineSetting> builtin_settings(std::size_t beams);

/// End of a series of rays. It ends before a setting that would probably take longer, which depends on the
/// machine, or that has more rays per ping, which does not.
struct LadderEnd {
  double seconds = std::numeric_limits<double>::infinity();
  double rays = std::numeric_limits<double>::infinity();
};

/// Runs the settings on a scene and calls `step` after each. Skips settings that cannot compute the scene
/// or lie beyond the end. Slow settings run once instead of `repeats` times. Throws Interrupted if the user
/// stops the program.
std::vector<Trial> all_trials(
    const TrialScene& scene, const std::vector<EngineSetting>& settings, int repeats, const LadderEnd& end,
    const std::function<void()>& step = [] {});

/// Selects the first pings of the first sensor.
TrialScene::Choice first_pings(std::size_t count);
/// Pings of the first sensor, as resolved() reads them.
TrialScene::Choice chosen_pings(const std::string& text);

}  // namespace tubefoot
