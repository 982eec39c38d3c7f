// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/run_warnings.hpp"

#include <algorithm>

#include "run/gradients.hpp"
#include "run/open_signals.hpp"
#include "run/placement.hpp"
#include "run/refraction.hpp"
#include "run/signal_gradients.hpp"

namespace tubefoot {

void RunWarnings::foresee(const Survey& survey, const RunRequest& request) {
  add(survey.scene.report.warnings);
  add(vast_windows(survey));
  if (request.reference_tolerance) add(open_signals(survey));
  add(missing_signal_gradients(survey, request));
  if (!survey.loaded_scene->has_surface_per_transmission() && !survey.loaded_scene->is_tiled())
    add(expected_no_returns(survey, request));
}

void RunWarnings::look_back(const Survey& survey, const RunRequest& request, const SimulationStats& stats,
                            const std::vector<Recording>& recordings) {
  add(refraction_warnings(survey, request.reference_tolerance.has_value(), stats));
  add(met_no_returns(survey, request, recordings));
  add(one_sided_derivatives(recordings));
}

void RunWarnings::add(const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) tell_(warning, false);
  keep(warnings);
}

void RunWarnings::add(const std::vector<NoReturn>& no_returns) {
  for (const NoReturn& no_return : no_returns) {
    if (std::ranges::find(silent_, no_return.sensor) != silent_.end()) continue;
    silent_.push_back(no_return.sensor);
    tell_(no_return.warning, true);
    keep({no_return.warning});
  }
}

void RunWarnings::keep(const std::vector<std::string>& warnings) {
  all_.insert(all_.end(), warnings.begin(), warnings.end());
}

}  // namespace tubefoot
