// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "files/input_error.hpp"

// Part of the description of a scene file: scene/description/scene_description.hpp.
namespace tubefoot {

/// Conversion of the relief of materials to facets.
struct RefinementDescription {
  SourcePlace place;
  std::string mode = "online";        ///< online | offline | off
  std::optional<double> cell_m;       ///< by default the finest detail of all relief
  std::string displace = "vertical";  ///< vertical | normal
  /// Online: relative RMS change of a range sample's energy. 0 means cells everywhere. The default is 0.01,
  /// unless a run requests a tolerance.
  std::optional<double> tolerance;
  std::optional<std::string>
      file;  ///< offline: resolved path of a file by 'tubefoot refine'; it is not part of the scene hash
  SourcePlace file_place;
};

}  // namespace tubefoot
