// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "scene/trajectory.hpp"
#include "sensors/detection/cell_means.hpp"

namespace tubefoot {

/// One received ping of a sidescan sonar.
struct SidescanPing {
  Pose pose;                               ///< of the sensor in the local frame
  double altitude_m = 0;                   ///< height of the sensor above the seabed below it
  double first_m = 0;                      ///< slant range at the start of sample 0
  double step_m = 0;                       ///< slant range of one sample
  std::span<const float> port, starboard;  ///< NaN: no value
};

/// Computes the contribution of a ping to a sidescan map, corrected for slant range over a flat seabed. An
/// echo from the slant range r lies sqrt(r^2 - altitude^2) from the track, at right angles to the heading.
/// Echoes from ranges below the altitude belong to the water column and are omitted. No correction for pitch
/// and roll takes place.
///
/// Each sample fills a strip of the seabed by area. The strip lies between the surface ranges of the
/// sample's start and end. It extends half the distance to the pings `before` and `after` on its line (null:
/// none). A map cell is the mean of its samples, weighted by area, at a resolution of at most a third of a
/// cell (CellMeans). A ping needs only the poses of its neighbours, so that the sums of all pings can be
/// computed in parallel.
///
/// Throws std::invalid_argument if the cell size is not positive, or for an invalid ping (ranges, altitude,
/// a sensor on its side). Throws std::runtime_error with advice for strips of excessive length.
CellSums sums_on_map(const SidescanPing& ping, const Pose* before, const Pose* after, double cell_m);

}  // namespace tubefoot
