// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string_view>

#include "engine/echo/echo.hpp"
#include "engine/rays/ray_sampling.hpp"
#include "geometry/visibility/visibility.hpp"
#include "run/selection.hpp"
#include "study/tolerance.hpp"

namespace tubefoot {

struct OwnEngine;
struct RunDescription;

enum class Engine { tube, ray };

/// All that is asked of a run's energies. Scene files, command lines and kept runs say it in words; inside
/// there are none.
struct RunRequest {
  Engine engine = Engine::tube;
  VisibilityOptions visibility;      ///< of tubes: arithmetic, and what goes with it
  Binning binning = Binning::exact;  ///< of tubes
  RaySettings rays{RaySampling::stratified, 100000, RaySettings::Per::ping, 1};
  std::optional<double> reference_tolerance;      ///< energies are enclosed, to this relative bound
  std::optional<Tolerance> tolerance;             ///< picks the settings above
  Selection selection{};                          ///< what is kept of the scene's echoes
  std::shared_ptr<const OwnEngine> own_engine{};  ///< in place of a built-in one
  double coarseness = 0;  ///< facets are coarsened to this tolerance (coarsening.hpp); 0: they are not
  bool labels = false;    ///< also whose each energy is, and where it comes from (labels.hpp)
  /// With `labels`: labels go by what is received within so many dB of a beam pattern's two-way peak.
  double label_level_db = 20;
};

/// Of the words of [run]. Throws UsageError for words that mean nothing.
RunRequest request_of(const RunDescription& run);

std::string_view name_of(Engine engine);

/// All settings of a built-in engine that energies depend on, and back, everything else as in `otherwise`.
/// The way back throws nlohmann::json::exception, and UsageError as request_of().
nlohmann::ordered_json json_of(const RunRequest& request);
RunRequest request_of(const nlohmann::ordered_json& settings, RunRequest otherwise);

}  // namespace tubefoot
