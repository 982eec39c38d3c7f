// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <span>

#include "engine/water/eigenray.hpp"
#include "engine/water/water_column.hpp"

namespace tubefoot {

/// Position of the end of a path over level mirrors after unfolding. Unfolding mirrors the rest of the path
/// at each mirror, so that a ray continues through the mirror. Heights are in the local frame.
struct Unfolding {
  double sign = 1, offset_m = 0;  ///< a height z at the end becomes sign z + offset
  double last_mirror_m = 0;
  int front = 0;  ///< side to which the last mirror reflects: 1 above it, -1 below it; 0: no mirror

  double height_m(double z_m) const { return sign * z_m + offset_m; }
  /// Returns false only if everything between two heights lies behind the last mirror or in its plane.
  bool may_reach(double lowest_m, double highest_m) const {
    return front == 0 || (front > 0 ? highest_m > last_mirror_m : lowest_m < last_mirror_m);
  }
};

/// Stratified water along a path over level mirrors. The rays over the mirrors are the rays through this
/// water that pass all mirrors in turn and do not turn between them. Reflection at a level plane changes the
/// sign of the grazing angle. Mirroring the water has the same effect, because Snell's law contains no sign
/// of the angle.
struct UnfoldedWater {
  WaterColumn water;
  EigenrayOptions rays;  ///< permitted turning depths: before the first mirror and after the last
  Unfolding unfolding;
};

/// Unfolds the water along a path over the mirrors at heights `mirrors_m`, in the order of the path. The
/// mirrors lie alternately above and below the path. `up_first`: the first mirror is above the source.
/// `surface_height_m`: height of depth 0, so that depth = surface height - z. Throws std::invalid_argument
/// for mirrors that do not alternate.
UnfoldedWater unfold(const WaterColumn& water, const EigenrayOptions& rays, double surface_height_m,
                     std::span<const double> mirrors_m, bool up_first);

}  // namespace tubefoot
