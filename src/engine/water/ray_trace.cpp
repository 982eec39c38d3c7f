// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/water/ray_trace.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "engine/water/ray_arc.hpp"

// Traces one ray through layers of constant sound-speed gradient as exact arcs of circles (ray_arc.hpp). The
// tube area per steradian is A = (range / p) s_launch s_here |dx/dp| / c_launch^2.
namespace tubefoot {
namespace {

/// a / b, or 1 if a and b are equal: both may be 0 for a horizontal launch or arrival.
double ratio(double a, double b) { return a == b ? 1 : a / b; }

class Tracer {
 public:
  Tracer(const WaterColumn& water, double depth_m, double launch_rad, const RayTraceOptions& options)
      : water_(water), profile_(water.profile), options_(options) {
    if (!(depth_m >= options.surface_m && depth_m <= options.bottom_m))
      throw std::invalid_argument(
          fmt::format("the ray starts at a depth of {} m, outside of the water from {} to {} m", depth_m,
                      options.surface_m, options.bottom_m));
    const double cosine = std::cos(launch_rad);
    if (!(cosine > 1e-12))
      throw std::invalid_argument("a ray that is traced in range must not start straight up or down");
    state_.depth_m = depth_m;
    state_.sine = std::sin(launch_rad);
    state_.cosine = cosine;
    launch_sine_ = std::abs(state_.sine);
    ray_ = {profile_.at(depth_m), launch_sine_, cosine};
    p_ = ray_.p();
    down_ = state_.sine > 0 || (state_.sine == 0 && bends_down(depth_m));
  }

  std::vector<RayNode> trace() {
    nodes_.push_back({RayEvent::launch, state_, {}});
    while (nodes_.back().event != RayEvent::end && nodes_.size() < options_.most_nodes &&
           reflections_ < options_.most_reflections)
      step();
    return std::move(nodes_);
  }

 private:
  /// The layer that a ray at this depth enters.
  std::size_t layer_ahead(double depth_m, bool down) const {
    const std::size_t layer = profile_.layer_at(depth_m);
    return !down && layer > 0 && depth_m == profile_.top_m(layer) ? layer - 1 : layer;
  }

  /// Whether a horizontal ray bends downwards. It bends towards slower sound.
  bool bends_down(double depth_m) const { return profile_.gradient_per_s(layer_ahead(depth_m, true)) < 0; }

  /// Follows the ray from the present node to the next border, including a turning point.
  void step() {
    const std::size_t layer = layer_ahead(state_.depth_m, down_);
    const double g = profile_.gradient_per_s(layer);
    const double ahead_m = down_ ? std::min(profile_.bottom_m(layer), options_.bottom_m)
                                 : std::max(profile_.top_m(layer), options_.surface_m);
    const double s1 = std::abs(state_.sine);
    const double c1 = profile_.speed_in(layer, state_.depth_m);
    const bool towards_faster = down_ ? g > 0 : g < 0;
    if (std::isinf(ahead_m) || (s1 == 0 && (g == 0 || towards_faster))) {
      finish(layer, 0, c1);  // the ray continues straight without end
      return;
    }
    const double c2 = profile_.speed_in(layer, ahead_m);
    const double sine2 = ray_.sine2_at(c2);
    RayNode next;
    next.state = state_;
    RaySums sums;
    double s2 = s1;
    const bool turns = towards_faster && sine2 <= 0;
    if (turns) {
      sums = turning_arc(s1, s1, p_, g);
      next.event = RayEvent::layer;
      next.turned_at_m = state_.depth_m + (1 / p_ - c1) / g;
    } else {
      s2 = std::sqrt(std::max(0.0, sine2));
      const double dz = std::abs(ahead_m - state_.depth_m);
      sums.reach = arc_reach(dz, c1, c2, s1, s2);
      sums.time_s = arc_time_s(dz, c1, c2, s1, s2, p_);
      sums.length_m = arc_length_m(dz, sums.reach, p_, g);
      next.state.depth_m = ahead_m;
      next.event = ahead_m == options_.bottom_m && down_     ? RayEvent::bottom
                   : ahead_m == options_.surface_m && !down_ ? RayEvent::surface
                                                             : RayEvent::layer;
    }
    if (state_.range_m + p_ * sums.reach >= options_.longest_range_m) {
      finish(layer, g, c1);
      return;
    }
    const bool bounces = next.event == RayEvent::bottom || next.event == RayEvent::surface;
    if (turns || bounces) down_ = !down_;
    if (bounces) ++reflections_;
    next.state.sine = down_ ? s2 : -s2;
    next.state.cosine = p_ * profile_.speed_in(layer, next.state.depth_m);
    add(layer, sums, s1, s2, turns, next.state);
    nodes_.push_back(next);
    state_ = nodes_.back().state;
  }

  /// The last piece, within one layer, to the longest range.
  void finish(std::size_t layer, double g, double c1) {
    RayNode last;
    last.event = RayEvent::end;
    last.state = state_;
    const double dx = options_.longest_range_m - state_.range_m;
    const double sine1 = state_.sine, sine2 = sine1 - p_ * g * dx;  // signed, positive down
    const bool turns = sine1 * sine2 < 0;
    const double s1 = std::abs(sine1), s2 = std::abs(sine2);
    RaySums sums;
    if (turns) {
      sums = turning_arc(s1, s2, p_, g);
      last.turned_at_m = state_.depth_m + (1 / p_ - c1) / g;
      last.state.depth_m += (s1 - s2) * (s1 + s2) / (p_ * p_ * g * (c1 + std::sqrt(1 - s2 * s2) / p_));
    } else {
      const double c2 = std::sqrt((1 - s2) * (1 + s2)) / p_;
      const double dz = dx * (s1 + s2) / (p_ * (c1 + c2));
      sums.reach = dx / p_;
      // A horizontal straight ray covers no depth.
      sums.time_s = dz > 0 ? arc_time_s(dz, c1, c2, s1, s2, p_) : dx / c1;
      sums.length_m = arc_length_m(dz, sums.reach, p_, g);
      last.state.depth_m += down_ ? dz : -dz;
    }
    last.state.sine = sine2;
    last.state.cosine = std::sqrt((1 - s2) * (1 + s2));
    add(layer, sums, s1, s2, turns, last.state);
    nodes_.push_back(last);
  }

  void add(std::size_t layer, const RaySums& sums, double s1, double s2, bool turns, RayState& to) {
    to.range_m += p_ * sums.reach;
    to.time_s += sums.time_s;
    to.length_m += sums.length_m;
    to.absorption_db += water_.absorption_in(layer) * sums.length_m;
    // A = (range / p) s_launch s_here |dx/dp| / c_launch^2. The derivative dx/dp is singular where a ray is
    // horizontal, but the product is finite. The sines are therefore multiplied in before the sum.
    const double c = ray_.sound_speed_m_s, from = ratio(launch_sine_, s1);
    const double piece = (turns ? -1 : 1) * sums.reach * from;
    const double spread = launch_dx_dp_ * s2 + piece;
    to.tube_area_m2_per_sr = to.range_m / p_ * std::abs(spread) / (c * c);
    launch_dx_dp_ += s2 > 0 ? piece / s2 : 0;
  }

  const WaterColumn& water_;
  const SoundSpeedProfile& profile_;
  RayTraceOptions options_;
  SnellRay ray_;
  double p_ = 0, launch_sine_ = 0;
  double launch_dx_dp_ = 0;  // launch sine times the sum of dx/dp
  bool down_ = true;
  std::size_t reflections_ = 0;
  RayState state_;
  std::vector<RayNode> nodes_;
};

}  // namespace

std::vector<RayNode> trace_ray(const WaterColumn& water, double launch_depth_m, double launch_rad,
                               const RayTraceOptions& options) {
  return Tracer(water, launch_depth_m, launch_rad, options).trace();
}

}  // namespace tubefoot
