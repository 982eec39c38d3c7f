// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "files/input_error.hpp"

// What a scene file says: scene/description/scene_description.hpp.
namespace tubefoot {

/// How the materials' relief gets into facets.
struct RefinementDescription {
  SourcePlace place;
  std::string mode = "online";        ///< online | offline | off
  std::optional<double> cell_m;       ///< else the finest detail of all relief
  std::string displace = "vertical";  ///< vertical | normal
  /// Online: RMS change of a range sample's energy, relative; 0: cells everywhere; none: 0.01, unless a run
  /// is asked for a tolerance.
  std::optional<double> tolerance;
  std::optional<std::string>
      file;  ///< offline: of 'tubefoot refine', resolved; it is no part of the scene hash
  SourcePlace file_place;
};

}  // namespace tubefoot
