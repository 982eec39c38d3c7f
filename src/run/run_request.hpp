// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/echo/echo.hpp"
#include "engine/rays/ray_sampling.hpp"
#include "geometry/visibility/visibility.hpp"
#include "run/selection.hpp"
#include "study/tolerance.hpp"

namespace tubefoot {

struct OwnEngine;
struct RunDescription;

enum class Engine { tube, ray };

/// All settings that determine the energies of a run. Scene files, command lines and checkpoints contain
/// them as text; this structure contains none.
struct RunRequest {
  Engine engine = Engine::tube;
  VisibilityOptions visibility;      ///< settings of the tube engine: arithmetic and its parameters
  Binning binning = Binning::exact;  ///< setting of the tube engine
  RaySettings rays{RaySampling::stratified, 100000, RaySettings::Per::ping, 1};
  /// if set, energies are enclosed in bounds of this relative width
  std::optional<double> reference_tolerance;
  std::optional<Tolerance> tolerance;             ///< if set, chooses the settings above
  Selection selection{};                          ///< echoes of the scene that the run stores
  std::shared_ptr<const OwnEngine> own_engine{};  ///< engine of the user in place of a built-in engine
  double coarseness = 0;  ///< tolerance to which facets are coarsened (coarsening.hpp); 0: no coarsening
  bool labels = false;    ///< if true, the run also stores the labels of each energy (labels.hpp)
  /// With `labels`: labels count the energy that is received within this level [dB] below the two-way peak
  /// of a beam pattern.
  double label_level_db = 20;
  /// Parameters by which the run also differentiates energies and signals (gradient_parameters.hpp).
  std::vector<std::string> gradient{};
  /// With `gradient`: the run also proves steps of the parameters without a change of visible polygons.
  bool gradient_steps = false;
  /// With a reference: energies are the midpoints of their enclosures, as in version 2 of the benchmark
  /// suite.
  bool keeps_midpoints = false;
  /// With a reference: corners that two apexes share are rounded to doubles, as in the published answers of
  /// the benchmark suite.
  bool rounds_corners = false;
};

/// Converts the texts of [run] to a request. Throws UsageError for an unknown text.
RunRequest request_of(const RunDescription& run);

std::string_view name_of(Engine engine);

/// Converts all settings of a built-in engine that affect energies to JSON and back. The inverse takes all
/// other settings from `otherwise`. It throws nlohmann::json::exception, and UsageError as request_of()
/// does.
nlohmann::ordered_json json_of(const RunRequest& request);
RunRequest request_of(const nlohmann::ordered_json& settings, RunRequest otherwise);

}  // namespace tubefoot
