// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "scene/rasters/earth_place.hpp"
#include "sensors/recordings/pose_angles.hpp"
#include "sensors/recordings/recording.hpp"
#include "sensors/recordings/run_context.hpp"

namespace tubefoot {

/// Where a sensor is at a ping, and how it lies: what goes out with a latitude and a longitude is true, not
/// of the map's grid. Of a scene without a place on Earth: longitude and latitude 0, directions from the
/// frame's own north, heights above its height 0.
struct NavigationFix {
  double unix_time_s = 0;
  EarthPlace place{};
  PoseAngles lie{};
  double course_deg = 0;  ///< over the surface; of a sensor that rests, its heading
  double speed_m_s = 0;   ///< over the surface
};

/// Of `count` pings from `first` on, with one transformation set up for all. Throws InputError where a ping
/// has no place on Earth.
std::vector<NavigationFix> navigation(const Recording& recording, const RunContext& run, std::size_t first,
                                      std::size_t count);

/// The same for pings that are asked for one after the other: a block of them is found at a time.
class NavigationTrack {
 public:
  /// What it is of must outlive it.
  NavigationTrack(const Recording& recording, const RunContext& run) : recording_(recording), run_(run) {}
  /// Until the next call.
  const NavigationFix& of(std::size_t ping);

 private:
  const Recording& recording_;
  const RunContext& run_;
  std::size_t first_ = 0;
  std::vector<NavigationFix> block_;
};

/// Over the surface and up, in the scene's frame, from the ping before to the one after; 0 where there is
/// none.
glm::dvec3 velocity_m_s(const Recording& recording, std::size_t ping);

}  // namespace tubefoot
