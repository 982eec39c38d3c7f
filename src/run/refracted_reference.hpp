// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "engine/certified/certified_refraction.hpp"
#include "run/shot_ground.hpp"

namespace tubefoot {

/// The certified echoes of one shot through refracting water, and the ground that they are of.
struct RefractedShot {
  ShotGround ground;
  History history;
  std::size_t candidates = 0;
  std::vector<RefractedReference> sensors;  ///< as the group's
  bool at_limit = false;  ///< bounds are wider than asked, and a finer ground would have too many facets
};

/// Straightens the ground of a shot ever finer, until all but a two-hundredth of the bounds that are finite
/// are within the tolerance, until that helps no more, or until the ground would have more facets than a
/// reference is worth.
RefractedShot certify_refracted_shot(const Survey& survey, const SharedShots& group, std::size_t ping,
                                     std::size_t shot, const VisibilityOptions& options, double tolerance);

}  // namespace tubefoot
