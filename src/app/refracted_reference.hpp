// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "app/shot_ground.hpp"
#include "engine/certified_refraction.hpp"

namespace tubefoot {

/// The certified echoes of one shot through refracting water, and the ground that they are of.
struct RefractedShot {
  ShotGround ground;
  History history;
  std::size_t candidates = 0;
  std::vector<RefractedReference> sensors;  ///< as the group's
};

/// Straightens the ground of a shot ever finer, until every bound that can be is within the tolerance or the
/// ground has more facets than a reference is worth; at most three times.
RefractedShot certify_refracted_shot(const Survey& survey, const SharedShots& group, std::size_t ping,
                                     std::size_t shot, const VisibilityOptions& options, double tolerance);

}  // namespace tubefoot
