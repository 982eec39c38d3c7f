// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "engine/certified/certified_refraction.hpp"
#include "run/refraction.hpp"
#include "run/shot.hpp"

namespace tubefoot {

/// The certified echoes of one shot through refracting water, and the ground that they are of.
struct RefractedShot {
  ShotGround ground;
  History history;
  std::size_t candidates = 0;
  std::vector<RefractedReference> sensors;  ///< as the group's; of staffs nothing
  bool at_limit = false;  ///< bounds are wider than asked, and a finer ground would have too many facets

  std::size_t facets() const { return ground.mesh().facets.size(); }
};

/// The same of a receiver apart, which has its shots for itself.
struct RefractedPairShot {
  RefractedPair pair;
  BistaticHistory history;
  std::vector<RefractedReference> sensors;  ///< one
  bool at_limit = false;

  std::size_t facets() const { return pair.apparent.mesh.facets.size(); }
};

/// The same of one fan of a staff.
struct RefractedStaffShot {
  AlikeGrounds apparent;                    ///< of the transmitter, of the upper and of the lower receiver
  BistaticHistory history;                  ///< of the upper one
  std::vector<RefractedReference> sensors;  ///< one, by rows (certify_refracted_staff())
  bool at_limit = false;

  std::size_t facets() const { return apparent.bed.mesh.facets.size(); }
};

/// Straightens the ground of a shot ever finer, until all but a two-hundredth of the bounds that are finite
/// are within the tolerance that the run asks for, until that helps no more, or until the ground would have
/// more facets than a reference is worth.
RefractedShot certify_refracted_shot(const Shot& shot);
RefractedPairShot certify_refracted_pair_shot(const Shot& shot);
RefractedStaffShot certify_refracted_staff_shot(const Shot& shot, std::size_t sensor, std::uint32_t fan);

/// The certified echoes of a sensor's paths over mirrors, by order.
struct RefractedPathsShot {
  PathEcho paths;
  std::vector<RefractedReference> orders;
  bool at_limit = false;

  std::size_t facets() const;
};
/// The same of these, whose images make grounds of their own: `trace` is path_echo() through a water.
RefractedPathsShot certify_refracted_paths(const Shot& shot, const PathWater& water, double reach_m,
                                           const std::function<PathEcho(const PathWater&)>& trace);

}  // namespace tubefoot
