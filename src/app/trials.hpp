// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "app/survey.hpp"
#include "scene/scene_description.hpp"
#include "study/work_precision.hpp"

namespace tubefoot {

/// One way to compute a scene.
struct EngineSetting {
  std::string engine, setting;  ///< for people: "rays, stratified", "114 a beam"
  RunDescription run;           ///< its engine, arithmetic, binning, rays and sampling count
  double rays = 0;              ///< a ping; 0 for tubes
};

/// Ways of the tube engine worth a chart: exact arithmetics, double, splitting, and the fast binnings.
std::vector<EngineSetting> tube_settings();

/// Ways of the ray engine on `beams` beams: each sampling on a ladder of rays a beam that goes through the
/// numbers that existing simulators use (1, 11, 23, 114, 1500, 17000).
std::vector<EngineSetting> ray_settings(std::size_t beams);

/// The first pings of a scene's first sensor, with a certified reference to hold engines against.
class TrialScene {
 public:
  /// Loads the scene and computes the reference. Throws as open_survey() and simulate() do.
  TrialScene(const std::filesystem::path& scene, std::size_t pings, double reference_tolerance);

  const std::string& name() const { return name_; }
  std::size_t beams() const { return survey_->sensors.front().sensor->beams().size(); }
  /// Of the reference: sum of its half-widths over the sum of its energies.
  double bound() const { return bound_; }

  /// Runs a setting `repeats` times; the median of the times counts, and the first run's energies.
  Trial run(const EngineSetting& setting, int repeats);

  /// Seconds a ping from a single run, energies not looked at.
  double seconds(const EngineSetting& setting);

 private:
  std::vector<double> energies(const EngineSetting& setting, double& seconds_a_ping);

  std::string name_;
  std::unique_ptr<Survey> survey_;
  std::vector<double> reference_, reference_bound_, ranges_m_;
  double bound_ = 0;
};

}  // namespace tubefoot
