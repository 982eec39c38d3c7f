// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <span>

#include "engine/water/eigenray.hpp"
#include "engine/water/water_column.hpp"

namespace tubefoot {

/// Where the end of a way over level mirrors lies if the way is unfolded: mirrored along with it, so that a
/// ray goes on through each mirror as if it were not there. Heights in the local frame.
struct Unfolding {
  double sign = 1, offset_m = 0;  ///< a height z at the end is sign z + offset
  double last_mirror_m = 0;
  int front = 0;  ///< what the last mirror reflects to: 1 above it, -1 below; 0: there is no mirror

  double height_m(double z_m) const { return sign * z_m + offset_m; }
  /// False only if all between two heights lies behind the last mirror, or in it.
  bool may_reach(double lowest_m, double highest_m) const {
    return front == 0 || (front > 0 ? highest_m > last_mirror_m : lowest_m < last_mirror_m);
  }
};

/// Layered water along a way over level mirrors. Rays through it that pass all mirrors in turn, without
/// turning between them, are the rays over the mirrors: reflection at a level plane changes the sign of the
/// grazing angle, as mirroring the water does (Snell's law has no other).
struct UnfoldedWater {
  WaterColumn water;
  EigenrayOptions rays;  ///< where they may turn: before the first mirror and after the last
  Unfolding unfolding;
};

/// `mirrors_m`: heights in the order of the way, each on the other side of the one before than the next;
/// `up_first`: the first is above the source. `surface_height_m`: depth = this - z. Throws
/// std::invalid_argument for mirrors that do not take turns.
UnfoldedWater unfold(const WaterColumn& water, const EigenrayOptions& rays, double surface_height_m,
                     std::span<const double> mirrors_m, bool up_first);

}  // namespace tubefoot
