// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "engine/water/sound_speed_profile.hpp"

namespace tubefoot {

/// Direction of a ray in its vertical plane, positive downwards. The cosine is 0 or more, and 0 for a
/// vertical ray.
struct RayDirection {
  double sine = 1, cosine = 0;  ///< of the grazing angle
};

/// Where a ray is after some time.
struct TimedRay {
  double range_m = 0;  ///< horizontal, from the launch
  double depth_m = 0;
  double shallowest_m = 0;  ///< least depth between the launch and this place
};

/// Follows a ray for `time_s` through any number of layers as exact arcs, with turning points and without
/// reflections. This is the inverse of an eigenray: launch direction and travel time are known, the place is
/// sought. Within a layer of gradient g the ray has closed forms in time, because
/// d(artanh(sine)) / dt = -g. Throws std::invalid_argument for a time that is negative or not finite.
TimedRay ray_after(const SoundSpeedProfile& profile, double launch_depth_m, RayDirection launch,
                   double time_s);

}  // namespace tubefoot
