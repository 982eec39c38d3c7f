// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "run/survey.hpp"

namespace tubefoot {

/// How an object stands to the seabed.
struct SeabedPlacement {
  std::string object;
  std::string words;    ///< "in the seabed: from 0.5 m below it to 0.5 m above"
  std::string warning;  ///< empty where that is nothing odd
  bool is_buried = false;
};

/// Of each object of a scene with terrain, by some of its vertices: what lies between them may differ. Throws
/// InputError for a raster that can no longer be read.
std::vector<SeabedPlacement> placements(const Survey& survey);

/// Warnings of sensors whose range window reaches far beyond all that there is.
std::vector<std::string> vast_windows(const Survey& survey);

}  // namespace tubefoot
