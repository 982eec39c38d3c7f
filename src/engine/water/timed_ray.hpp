// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "engine/water/sound_speed_profile.hpp"

namespace tubefoot {

/// Direction of a ray in its vertical plane, positive downwards. The cosine is never negative, and 0 for a
/// vertical ray.
struct RayDirection {
  double sine = 1, cosine = 0;  ///< of the grazing angle
};

/// Position of a ray after a given time.
struct TimedRay {
  double range_m = 0;  ///< horizontal, from the launch
  double depth_m = 0;
  double shallowest_m = 0;  ///< least depth between the launch and this position
};

/// Follows a ray for `time_s` through any number of layers as exact arcs, with turning points and without
/// reflections. This solves the inverse problem of an eigenray: launch direction and travel time are known,
/// and the position is sought. Within a layer of gradient g the ray has closed forms in time, because
/// d(artanh(sine)) / dt = -g. Throws std::invalid_argument for a time that is negative or not finite.
TimedRay ray_after(const SoundSpeedProfile& profile, double launch_depth_m, RayDirection launch,
                   double time_s);

}  // namespace tubefoot
