// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "scene/trajectory.hpp"
#include "sensors/detection/cell_means.hpp"

namespace tubefoot {

/// What a sidescan received of one ping.
struct SidescanPing {
  Pose pose;                               ///< of the sensor in the local frame
  double altitude_m = 0;                   ///< height of the sensor above the seabed below it
  double first_m = 0;                      ///< slant range at which sample 0 begins
  double step_m = 0;                       ///< slant range of one sample
  std::span<const float> port, starboard;  ///< NaN: no value
};

/// What a ping puts on a map of a sidescan's pings, corrected for slant range as if the seabed were flat:
/// what came back from the slant range r lies sqrt(r^2 - altitude^2) from the track, at right angles to the
/// heading; what came before the altitude is water and left out. Attitude beyond the heading is not corrected
/// for.
///
/// Each sample fills, by area, the strip of the seabed between the surface ranges at which it begins and ends
/// and half the way to the pings `before` and `after` on its line; null: there is none. A cell is the mean of
/// the samples over it, weighted by area (sampled no coarser than a third of a cell): that of the sums of all
/// pings (CellMeans). A ping asks for poses alone of its neighbours, so that all pings' sums may be made at a
/// time.
///
/// Throws std::invalid_argument for a cell that is not positive or a ping that makes no sense (ranges,
/// altitude, a sensor on its side), std::runtime_error for strips without end, and says what to do.
CellSums sums_on_map(const SidescanPing& ping, const Pose* before, const Pose* after, double cell_m);

}  // namespace tubefoot
