// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "scene/rasters/earth_place.hpp"
#include "sensors/recordings/pose_angles.hpp"
#include "sensors/recordings/recording.hpp"
#include "sensors/recordings/run_context.hpp"

namespace tubefoot {

/// Position and attitude of a sensor at a ping. Directions that accompany a latitude and a longitude are
/// relative to true north, not to the grid of the map. Without a place on Earth longitude and latitude are
/// 0. Directions then count from the frame's north, and heights from its height 0.
struct NavigationFix {
  double unix_time_s = 0;
  EarthPlace place{};
  PoseAngles lie{};
  double course_deg = 0;  ///< over the surface; the heading of a sensor at rest
  double speed_m_s = 0;   ///< over the surface
};

/// Fixes of `count` pings from `first` on, with one transformation for all. Throws InputError if a ping has
/// no place on Earth.
std::vector<NavigationFix> navigation(const Recording& recording, const RunContext& run, std::size_t first,
                                      std::size_t count);

/// The same for consecutive queries: it computes a block of pings at a time.
class NavigationTrack {
 public:
  /// The arguments must outlive the object.
  NavigationTrack(const Recording& recording, const RunContext& run) : recording_(recording), run_(run) {}
  /// The reference is valid until the next call.
  const NavigationFix& of(std::size_t ping);

 private:
  const Recording& recording_;
  const RunContext& run_;
  std::size_t first_ = 0;
  std::vector<NavigationFix> block_;
};

/// Velocity over the surface and up, in the scene's frame, from the previous ping to the next one; 0 if
/// there is none.
glm::dvec3 velocity_m_s(const Recording& recording, std::size_t ping);

}  // namespace tubefoot
