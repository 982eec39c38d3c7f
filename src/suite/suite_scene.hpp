// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "suite/draw.hpp"
#include "suite/solids.hpp"

namespace tubefoot {

/// A measure of compare.py with the limit that decides whether an engine has a scene's aspect.
struct Decider {
  std::string measure;
  double limit = 0;
};

/// A scene of target strength: a body, the directions to the sonar at elevation 0, and frequencies.
struct StrengthBody {
  std::string_view name;  ///< of its files in scenes/betssi
  std::vector<double> azimuths_deg, frequencies_hz;
};

/// A scene of the benchmark suite before it is written.
struct SuiteScene {
  std::string title;
  std::vector<Solid> solids;  ///< in the order of the scene file
  std::string text;           ///< text of the scene file
  std::vector<Decider> deciders;
  /// Relative bound that the reference proves for every energy (docs/notes/certified-energies.md). It is
  /// empty if no reference is possible.
  std::optional<double> certified = 1e-9;
  double tolerance_l1 = 0;  ///< without a reference: allowed relative error of the sum of all energies
  std::optional<double> later_from_m{};    ///< range from which on all arrivals have two bounces
  std::optional<int> main_lobe_beams{};    ///< half width of the main lobe, in beams
  std::optional<double> water_to_m{};      ///< range up to which only the water scatters
  std::vector<std::string> gradient{};     ///< parameters of the derivatives, of a scene with one ping
  bool has_sharp_answer = false;           ///< whether the answer also has energies with sharp shadow borders
  std::optional<StrengthBody> strength{};  ///< in place of solids, text and energies
};

/// A property of engines that one scene of the suite tests separately from all others.
struct Aspect {
  std::string_view name, tests;
  SuiteScene (*scene)(Draw& draw);
};

/// A published version of the suite. Its debug set keeps its bytes.
struct SuiteVersion {
  int number = 0;
  std::span<const Aspect> aspects;  ///< in the order of the README
  std::string_view full_number;
  std::string_view heading;  ///< first line of the scene files
  std::string_view title;    ///< of pack.json
  /// Largest limit of this measure in any scene; empty: the limits of the scenes.
  std::optional<double> samples_moved_limit;
  /// Whether energies are the midpoints of their enclosures. Otherwise they are the ordinary energies,
  /// clipped to the enclosures, because midpoints are biased where enclosures are one-sided.
  bool has_midpoints = false;
};

constexpr int newest_suite = 3;

SuiteVersion second_version();
/// Returns a version that `suite` writes. Throws UsageError for any other number.
const SuiteVersion& suite_version(int number);

// The scenes, grouped by topic. Each group has one file.
SuiteScene range_law_scene(Draw& draw);
SuiteScene absorption_scene(Draw& draw);
SuiteScene grazing_scene(Draw& draw);
SuiteScene equiangular_scene(Draw& draw);
SuiteScene equidistant_scene(Draw& draw);
SuiteScene listed_angles_scene(Draw& draw);
SuiteScene side_lobes_scene(Draw& draw);
SuiteScene near_plane_scene(Draw& draw);
SuiteScene thin_wall_scene(Draw& draw);
SuiteScene silhouettes_scene(Draw& draw);
SuiteScene occlusion_order_scene(Draw& draw);
SuiteScene large_flat_scene(Draw& draw);
SuiteScene many_small_scene(Draw& draw);
SuiteScene terrain_scene(Draw& draw);
SuiteScene moving_sonar_scene(Draw& draw);
SuiteScene layered_water_scene(Draw& draw);
SuiteScene surface_multiple_scene(Draw& draw);
SuiteScene two_scatterings_scene(Draw& draw);
SuiteScene separate_receivers_scene(Draw& draw);
// Since version 3:
SuiteScene volume_scene(Draw& draw);
SuiteScene half_sample_scene(Draw& draw);
SuiteScene transmit_sectors_scene(Draw& draw);
SuiteScene moving_object_scene(Draw& draw);
SuiteScene derivatives_scene(Draw& draw);
SuiteScene shadow_border_scene(Draw& draw);
SuiteScene strength_m3_scene(Draw& draw);
SuiteScene strength_m5a_scene(Draw& draw);
SuiteScene strength_m5b_scene(Draw& draw);

}  // namespace tubefoot
