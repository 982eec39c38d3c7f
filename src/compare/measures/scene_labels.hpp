// SPDX-License-Identifier: GPL-3.0-or-later
// Knowledge of the scene about the bins of a picture, which the diagnosis uses to name causes.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace tubefoot {

/// Labels of the bins of a pair of pictures, in the order of their energies. Empty lists: unknown.
struct SceneLabels {
  static constexpr std::uint16_t none = 0xffff;
  std::vector<float> elevation_deg;     ///< mean elevation of the echo above the axis of the sonar; or NaN
  std::vector<std::uint16_t> material;  ///< material of at least nine tenths of the energy; or none
  /// Object nearer than the first range bin whose shadow the bin lies in; or none
  std::vector<std::uint16_t> near_caster;
  std::vector<std::string> material_names, object_names;
};

}  // namespace tubefoot
