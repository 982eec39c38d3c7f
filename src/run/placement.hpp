// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "run/survey.hpp"

namespace tubefoot {

/// Position of an object relative to the seabed.
struct SeabedPlacement {
  std::string object;
  std::string words;    ///< "partly buried: from 0.5 m below the seabed to 0.5 m above"
  std::string warning;  ///< empty if the position is plausible
  bool is_buried = false;
};

/// Returns the position of each object of a scene with terrain, from some of its vertices. Between these
/// vertices the height above the seabed may differ. Throws InputError if a raster can no longer be read.
std::vector<SeabedPlacement> placements(const Survey& survey);

/// Returns warnings for sensors whose range gate extends far beyond all facets.
std::vector<std::string> vast_windows(const Survey& survey);

}  // namespace tubefoot
