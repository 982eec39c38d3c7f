// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "study/diagram.hpp"
#include "study/work_precision.hpp"

namespace tubefoot {

/// Conclusion from the trials of one scene about the choice of an engine.
struct SceneVerdict {
  std::string scene;
  WorkMeasure work = WorkMeasure::seconds;
  /// Work of the best sampling setting divided by that of the best exact setting, at 0.1 dB RMS and at 1e-3
  /// L1.
  std::optional<double> ray_over_tube_at_db, ray_over_tube_at_l1;
  bool db_extrapolated = false, l1_extrapolated = false;  ///< the sampling trials do not reach this error
  double crossing_l1 = 0;                                 ///< above this L1 error, sampling needs less work
};

SceneVerdict verdict_of(const std::string& scene, std::span<const Trial> trials,
                        WorkMeasure work = WorkMeasure::seconds);

/// Returns "seconds", "processor time" or "instructions".
std::string name_of(WorkMeasure work);

/// Returns a diagram of error over seconds, one line per engine.
Diagram work_precision_plot(const std::string& scene, std::span<const Trial> trials, ErrorMeasure measure);

/// Returns a table with one row per trial: scene, engine, setting, l1_error, rms_db_error, seconds, bound,
/// processor_seconds, instructions. The last column is empty if instructions are not counted.
std::string to_csv(std::span<const Trial> trials);

/// Returns one self-contained page with verdicts, diagrams and the table. `about`: a sentence on the
/// measurement.
std::string to_html(std::span<const Trial> trials, const std::string& about);

/// Returns the scenes in the order of their first trials.
std::vector<std::string> scenes_of(std::span<const Trial> trials);
std::vector<Trial> of_scene(std::span<const Trial> trials, const std::string& scene);

}  // namespace tubefoot
