// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "study/diagram.hpp"
#include "study/work_precision.hpp"

namespace tubefoot {

/// What the trials of one scene say about the choice of an engine.
struct SceneVerdict {
  std::string scene;
  WorkMeasure work = WorkMeasure::seconds;
  /// Work of the best sampling setting over that of the best exact one, at 0.1 dB RMS and at 1e-3 L1.
  std::optional<double> ray_over_tube_at_db, ray_over_tube_at_l1;
  bool db_extrapolated = false, l1_extrapolated = false;  ///< the sampling side was not measured that far
  double crossing_l1 = 0;                                 ///< above this L1 error, sampling is cheaper
};

SceneVerdict verdict_of(const std::string& scene, std::span<const Trial> trials,
                        WorkMeasure work = WorkMeasure::seconds);

/// "seconds", "processor time", "instructions".
std::string name_of(WorkMeasure work);

/// Error over seconds, a line an engine.
Diagram work_precision_plot(const std::string& scene, std::span<const Trial> trials, ErrorMeasure measure);

/// One row a trial: scene, engine, setting, l1_error, rms_db_error, seconds, bound, processor_seconds,
/// instructions (empty where they are not counted).
std::string to_csv(std::span<const Trial> trials);

/// One self-contained page: verdicts, diagrams, the table. `about` is a sentence on how it was made.
std::string to_html(std::span<const Trial> trials, const std::string& about);

/// Scenes in the order of their first trials.
std::vector<std::string> scenes_of(std::span<const Trial> trials);
std::vector<Trial> of_scene(std::span<const Trial> trials, const std::string& scene);

}  // namespace tubefoot
