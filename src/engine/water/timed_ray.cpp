// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/water/timed_ray.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "engine/water/ray_arc.hpp"

// Follows a ray for a given time through layers of constant gradient g. In each layer artanh(sine of the
// grazing angle) is linear in time with slope -g, which gives closed forms of depth and range.
namespace tubefoot {
namespace {

class TimedTrace {
 public:
  TimedTrace(const SoundSpeedProfile& profile, double depth_m, RayDirection launch)
      : profile_(profile),
        ray_{profile.at(depth_m), std::abs(launch.sine), launch.cosine},
        p_(ray_.p()),
        place_{0, depth_m, depth_m},
        sine_(std::abs(launch.sine)) {
    down_ = launch.sine > 0 || (launch.sine == 0 && profile_.gradient_per_s(layer_ahead(true)) < 0);
  }

  TimedRay after(double time_s) {
    while (pass_layer(time_s)) {
    }
    return place_;
  }

 private:
  /// The layer that the ray enters.
  std::size_t layer_ahead(bool down) const {
    const std::size_t layer = profile_.layer_at(place_.depth_m);
    return !down && layer > 0 && place_.depth_m == profile_.top_m(layer) ? layer - 1 : layer;
  }

  /// Follows the ray to the end of the layer, or around a turning point back to the depth at which it
  /// entered. Returns false if the time ends within the layer. Subtracts the used time from `time_s`.
  bool pass_layer(double& time_s) {
    const std::size_t layer = layer_ahead(down_);
    const double gradient = profile_.gradient_per_s(layer);
    const double speed = profile_.speed_in(layer, place_.depth_m);
    const bool towards_faster = down_ ? gradient > 0 : gradient < 0;
    if ((sine_ == 0 && (gradient == 0 || towards_faster)) || is_trapped(speed)) {
      place_.range_m += speed * time_s;
      return false;
    }
    const double ahead_m = down_ ? profile_.bottom_m(layer) : profile_.top_m(layer);
    if (std::isinf(ahead_m)) return end_within(gradient, speed, time_s);
    const double speed_ahead = profile_.speed_in(layer, ahead_m);
    const double sine2 = ray_.sine2_at(speed_ahead);
    if (towards_faster && sine2 <= 0) {
      const RaySums arc = turning_arc(sine_, sine_, p_, gradient);
      if (arc.time_s >= time_s) return end_within(gradient, speed, time_s);
      time_s -= arc.time_s;
      place_.range_m += p_ * arc.reach;
      if (!down_) rise_to(place_.depth_m + (1 / p_ - speed) / gradient);
      down_ = !down_;
      return true;
    }
    const double sine_ahead = std::sqrt(std::max(0.0, sine2)), dz = std::abs(ahead_m - place_.depth_m);
    const double needs_s = arc_time_s(dz, speed, speed_ahead, sine_, sine_ahead, p_);
    if (needs_s >= time_s) return end_within(gradient, speed, time_s);
    time_s -= needs_s;
    place_.range_m += p_ * arc_reach(dz, speed, speed_ahead, sine_, sine_ahead);
    place_.depth_m = ahead_m;
    rise_to(ahead_m);
    sine_ = sine_ahead;
    return true;
  }

  /// Returns whether a nearly horizontal ray oscillates about the axis of a sound channel by at most 0.1 um.
  /// Such a ray would cross the axis without end, so it is treated as horizontal.
  bool is_trapped(double speed) const {
    constexpr double least_swing_m = 1e-7;
    const std::size_t layer = profile_.layer_at(place_.depth_m);
    if (layer == 0 || place_.depth_m != profile_.top_m(layer)) return false;
    const double above = profile_.gradient_per_s(layer - 1), below = profile_.gradient_per_s(layer);
    return above < 0 && below > 0 && speed * sine_ * sine_ / 2 < least_swing_m * std::min(-above, below);
  }

  /// With a = gradient * time, the sine and cosine after this time follow from artanh(sine) - a, and the
  /// depth from Snell's law. No form divides by the gradient or by the cosine.
  bool end_within(double gradient, double speed, double time_s) {
    const double a = gradient * time_s, sine = down_ ? sine_ : -sine_, cosine = p_ * speed;
    const double sinh_a = std::sinh(a), half = std::sinh(a / 2);
    const double sinh_ratio = a == 0 ? 1 : sinh_a / a, cosh_ratio = a == 0 ? 0 : 2 * half * half / a;
    // Sound speed here divided by the speed at the end.
    const double slowed = 1 - sine * sinh_a + 2 * half * half;
    if (sine < 0 && sine * std::cosh(a) > sinh_a) rise_to(place_.depth_m + (1 / p_ - speed) / gradient);
    place_.range_m += cosine * speed * time_s * sinh_ratio / slowed;
    place_.depth_m += speed * time_s * (sine * sinh_ratio - cosh_ratio) / slowed;
    rise_to(place_.depth_m);
    return false;
  }

  void rise_to(double depth_m) { place_.shallowest_m = std::min(place_.shallowest_m, depth_m); }

  const SoundSpeedProfile& profile_;
  SnellRay ray_;
  double p_;
  TimedRay place_;
  double sine_;  // of the grazing angle, without sign
  bool down_ = true;
};

}  // namespace

TimedRay ray_after(const SoundSpeedProfile& profile, double launch_depth_m, RayDirection launch,
                   double time_s) {
  if (!(time_s >= 0 && std::isfinite(time_s)))
    throw std::invalid_argument(
        fmt::format("the travel time of a ray is {} s, but must be finite and 0 or more", time_s));
  return TimedTrace(profile, launch_depth_m, launch).after(time_s);
}

}  // namespace tubefoot
