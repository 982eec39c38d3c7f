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

/// A measure of compare.py by which an engine has, or has not, a scene's aspect.
struct Decider {
  std::string measure;
  double limit = 0;
};

/// A scene of the benchmark suite, before it is written.
struct SuiteScene {
  std::string title;
  std::vector<Solid> solids;  ///< as the scene file names them
  std::string text;           ///< the scene file
  std::vector<Decider> deciders;
  /// Bound that is proven of every energy (docs/reference.md); none where no reference is possible.
  std::optional<double> certified = 1e-9;
  double tolerance_l1 = 0;               ///< without: how far the sum of all may be off, relative
  std::optional<double> later_from_m{};  ///< what arrives from here on went over two bounces
  std::optional<int> main_lobe_beams{};  ///< half the main lobe, in beams
};

/// What one scene of the pack separates from all else.
struct Aspect {
  std::string_view name, tests;
  SuiteScene (*scene)(Draw& draw);
};

/// All, as the pack's README lists them.
std::span<const Aspect> aspects();

// By what they are of; each has one file.
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

}  // namespace tubefoot
