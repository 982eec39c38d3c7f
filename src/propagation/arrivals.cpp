// SPDX-License-Identifier: GPL-3.0-or-later
#include "propagation/arrivals.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "engine/water/eigenray.hpp"
#include "engine/water/unfolding.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

constexpr double upright_cosine = 1e-9;  // a steeper ray is treated as vertical
constexpr double steepest_rad = std::numbers::pi / 2 - 1e-6;

bool is_vertical(double launch_rad) { return std::cos(launch_rad) < upright_cosine; }

/// Searches reflected eigenrays by the depth of traced rays at the range of the point.
class ReflectedSearch {
 public:
  ReflectedSearch(const WaterColumn& water, double source_m, double depth_m, double range_m,
                  const ArrivalOptions& options)
      : water_(water), source_m_(source_m), depth_m_(depth_m), range_m_(range_m), options_(options) {
    // No ray passes a reflector, so a point on it would have rays on one side only.
    constexpr double clearance_m = 1e-6;
    if (depth_m == options.surface_m) depth_m_ += clearance_m;
    if (depth_m == options.bottom_m) depth_m_ -= clearance_m;
    // One reflection more than requested, so that the depth is known on both sides of every requested ray.
    trace_.surface_m = options.surface_m;
    trace_.bottom_m = options.bottom_m;
    trace_.longest_range_m = range_m;
    trace_.most_reflections = static_cast<std::size_t>(options.most_reflections) + 2;
  }

  std::vector<RayArrival> found() {
    const int steps = static_cast<int>(std::ceil(2 * steepest_rad / options_.finest_rad));
    const auto angle_rad = [&](int k) { return steepest_rad * (2.0 * k / steps - 1); };
    Launch before = launched(angle_rad(0)), here = before, earlier = before;
    for (int k = 1; k <= steps; ++k) {
      here = launched(angle_rad(k));
      between(before, here, 0);
      if (k > 1) near_touch(earlier, before, here);
      earlier = before;
      before = here;
    }
    return std::move(arrivals_);
  }

 private:
  /// A traced ray: how far below the point it passes, and its turns and reflections.
  struct Launch {
    double launch_rad = 0, miss_m = 0;
    int turns = 0, surface = 0, bottom = 0;
    bool arrives = false;
    bool below() const { return miss_m > 0; }
    bool downwards() const { return launch_rad > 0; }
    int reflections() const { return surface + bottom; }
  };

  std::vector<RayNode> nodes(double launch_rad) const {
    return trace_ray(water_, source_m_, launch_rad, trace_);
  }

  Launch launched(double launch_rad) const {
    Launch result{launch_rad};
    const std::vector<RayNode> traced = nodes(launch_rad);
    for (const RayNode& node : traced) {
      result.turns += node.turned_at_m ? 1 : 0;
      result.surface += node.event == RayEvent::surface ? 1 : 0;
      result.bottom += node.event == RayEvent::bottom ? 1 : 0;
    }
    result.arrives = traced.back().event == RayEvent::end;
    result.miss_m = traced.back().state.depth_m - depth_m_;
    return result;
  }

  /// Whether neighbours turn and reflect in the same order. The depth of their ends is then a smooth function
  /// of the launch angle.
  static bool same_path(const Launch& a, const Launch& b) {
    const bool straight = a.turns + a.reflections() == 0;
    return a.arrives == b.arrives && a.turns == b.turns && a.surface == b.surface && a.bottom == b.bottom &&
           (straight || a.downwards() == b.downwards());
  }

  void between(const Launch& a, const Launch& b, int halvings) {
    constexpr int most_halvings = 28;
    const bool too_many = std::min(a.reflections(), b.reflections()) > options_.most_reflections;
    if (a.downwards() == b.downwards() && (too_many || (!a.arrives && !b.arrives))) return;
    if (!same_path(a, b) && halvings < most_halvings) {
      const Launch middle = launched((a.launch_rad + b.launch_rad) / 2);
      between(a, middle, halvings + 1);
      between(middle, b, halvings + 1);
      return;
    }
    if (a.arrives && b.arrives && a.below() != b.below()) add_root(a, b);
  }

  /// Near a caustic two rays can lie between neighbours on one side of the point. The extremum of the miss
  /// shows whether they do.
  void near_touch(const Launch& a, const Launch& middle, const Launch& b) {
    if (!a.arrives || !middle.arrives || !b.arrives) return;
    if (a.below() != middle.below() || b.below() != middle.below()) return;
    const double side = middle.below() ? 1 : -1;
    if (!(side * middle.miss_m < side * a.miss_m && side * middle.miss_m <= side * b.miss_m)) return;
    if (!same_path(a, middle) || !same_path(middle, b)) return;
    constexpr double golden = 0.3819660112501051;
    Launch low = a, best = middle, high = b;
    for (int k = 0; k < 60 && best.below() == middle.below(); ++k) {
      const bool upper = high.launch_rad - best.launch_rad > best.launch_rad - low.launch_rad;
      const Launch trial = launched(best.launch_rad + golden * (upper ? high.launch_rad - best.launch_rad
                                                                      : low.launch_rad - best.launch_rad));
      if (!trial.arrives) return;
      const bool better = side * trial.miss_m < side * best.miss_m;
      if (better)
        (upper ? low : high) = std::exchange(best, trial);
      else
        (upper ? high : low) = trial;
    }
    if (best.below() == middle.below()) return;
    between(low, best, 0);
    between(best, high, 0);
  }

  void add_root(Launch a, Launch b) {
    const bool rising = b.below();  // steeper downwards arrives deeper
    for (;;) {
      const double middle_rad = a.launch_rad + (b.launch_rad - a.launch_rad) / 2;
      if (!(middle_rad > a.launch_rad && middle_rad < b.launch_rad)) break;
      const Launch middle = launched(middle_rad);
      if (!middle.arrives) return;
      (middle.below() == a.below() ? a : b) = middle;
    }
    const Launch& root = std::abs(a.miss_m) <= std::abs(b.miss_m) ? a : b;
    // A jump of the depth, where neighbours take different paths, is no ray.
    if (!(std::abs(root.miss_m) <= 1e-6 + 1e-9 * range_m_)) return;
    if (root.reflections() == 0 || root.reflections() > options_.most_reflections) return;
    const std::vector<RayNode> traced = nodes(root.launch_rad);
    const RayState& end = traced.back().state;
    RayArrival arrival;
    arrival.launch_rad = root.launch_rad;
    arrival.arrival_rad = std::atan2(end.sine, end.cosine);
    arrival.time_s = end.time_s;
    arrival.length_m = end.length_m;
    arrival.absorption_db = end.absorption_db;
    arrival.tube_area_m2_per_sr = end.tube_area_m2_per_sr;
    arrival.turning_depths_m = turning_depths(traced);
    for (const RayNode& node : traced) {
      arrival.surface_reflections += node.event == RayEvent::surface ? 1 : 0;
      arrival.bottom_reflections += node.event == RayEvent::bottom ? 1 : 0;
    }
    // Each reflection inverts the order of neighbours, and so does each caustic.
    arrival.crossed = rising == (arrival.reflections() % 2 != 0);
    arrivals_.push_back(std::move(arrival));
  }

  const WaterColumn& water_;
  double source_m_, depth_m_, range_m_;
  ArrivalOptions options_;
  RayTraceOptions trace_;
  std::vector<RayArrival> arrivals_;
};

RayArrival arrival_of(const Eigenray& ray) {
  RayArrival arrival;
  arrival.launch_rad = std::atan2(ray.launch_sine, ray.launch_cosine);
  arrival.arrival_rad = std::atan2(ray.arrival_sine, ray.arrival_cosine);
  arrival.time_s = ray.time_s;
  arrival.length_m = ray.length_m;
  arrival.absorption_db = ray.absorption_db;
  arrival.tube_area_m2_per_sr = ray.tube_area_m2_per_sr;
  arrival.crossed = ray.crossed;
  return arrival;
}

/// Returns the vertical rays with reflections: the monotone rays through the unfolded water.
std::vector<RayArrival> vertical_reflections(const WaterColumn& water, double source_m, double depth_m,
                                             const ArrivalOptions& options) {
  std::vector<RayArrival> found;
  for (const bool up_first : {true, false}) {
    std::vector<double> mirrors_m;  // heights above depth 0
    bool up = up_first;
    for (int n = 1; n <= options.most_reflections; ++n, up = !up) {
      const double mirror_m = up ? options.surface_m : options.bottom_m;
      if (!std::isfinite(mirror_m)) break;
      mirrors_m.push_back(-mirror_m);
      const UnfoldedWater unfolded =
          unfold(water, {options.surface_m, options.bottom_m, 0}, 0, mirrors_m, up_first);
      const auto ray = EigenrayFinder(unfolded.water, source_m, {-infinite, infinite, 0})
                           .direct(-unfolded.unfolding.height_m(-depth_m), 0);
      if (!ray) continue;
      RayArrival arrival = arrival_of(*ray);
      if (n % 2 != 0) arrival.arrival_rad = -arrival.arrival_rad;
      const int first = (n + 1) / 2, second = n / 2;
      arrival.surface_reflections = up_first ? first : second;
      arrival.bottom_reflections = up_first ? second : first;
      found.push_back(std::move(arrival));
    }
  }
  return found;
}

}  // namespace

std::vector<double> turning_depths(const std::vector<RayNode>& nodes) {
  std::vector<double> depths_m;
  for (const RayNode& node : nodes)
    if (node.turned_at_m) depths_m.push_back(*node.turned_at_m);
  return depths_m;
}

double spreading_loss_db(double tube_area_m2_per_sr, double source_speed_m_s, double speed_m_s) {
  return 10 * std::log10(tube_area_m2_per_sr * source_speed_m_s / speed_m_s);
}

std::vector<RayArrival> arrivals(const WaterColumn& water, double source_depth_m, double depth_m,
                                 double range_m, const ArrivalOptions& options) {
  for (const double depth : {source_depth_m, depth_m})
    if (!(depth >= options.surface_m && depth <= options.bottom_m))
      throw std::invalid_argument(fmt::format("the depth {} m lies outside of the water", depth));
  if (range_m == 0 && depth_m == source_depth_m)
    throw std::invalid_argument("a ray to the source itself has no direction");
  std::vector<RayArrival> found;
  const EigenrayFinder finder(water, source_depth_m,
                              {options.surface_m, options.bottom_m, options.most_turns});
  for (const Eigenray& ray : finder.all(depth_m, range_m)) {
    RayArrival arrival = arrival_of(ray);
    if (ray.turns > 0 && !is_vertical(arrival.launch_rad))
      arrival.turning_depths_m =
          turning_depths(trace_ray(water, source_depth_m, arrival.launch_rad, {.longest_range_m = range_m}));
    found.push_back(std::move(arrival));
  }
  if (options.most_reflections > 0) {
    std::vector<RayArrival> reflected =
        range_m > 0 ? ReflectedSearch(water, source_depth_m, depth_m, range_m, options).found()
                    : vertical_reflections(water, source_depth_m, depth_m, options);
    // At an end on a reflector, the reflected ray is the same as the ray before its reflection.
    std::erase_if(reflected, [&](const RayArrival& ray) {
      return (depth_m == options.bottom_m && ray.arrival_rad < 0) ||
             (depth_m == options.surface_m && ray.arrival_rad > 0) ||
             (source_depth_m == options.bottom_m && ray.launch_rad > 0) ||
             (source_depth_m == options.surface_m && ray.launch_rad < 0);
    });
    std::ranges::move(reflected, std::back_inserter(found));
  }
  std::ranges::stable_sort(found, {}, &RayArrival::time_s);
  return found;
}

std::vector<RayNode> path_of(const RayArrival& arrival, const WaterColumn& water, double source_depth_m,
                             double depth_m, double range_m, const ArrivalOptions& options) {
  if (!is_vertical(arrival.launch_rad)) {
    RayTraceOptions trace{.longest_range_m = range_m};
    if (arrival.reflections() > 0) {
      trace.surface_m = options.surface_m;
      trace.bottom_m = options.bottom_m;
    }
    return trace_ray(water, source_depth_m, arrival.launch_rad, trace);
  }
  std::vector<RayNode> nodes(1);
  double sine = std::sin(arrival.launch_rad);
  nodes[0].state = {.range_m = 0, .depth_m = source_depth_m, .sine = sine, .cosine = 0};
  for (int n = 0; n < arrival.reflections(); ++n, sine = -sine)
    nodes.push_back({sine < 0 ? RayEvent::surface : RayEvent::bottom,
                     {.range_m = 0,
                      .depth_m = sine < 0 ? options.surface_m : options.bottom_m,
                      .sine = -sine,
                      .cosine = 0},
                     {}});
  nodes.push_back({RayEvent::end, {.range_m = range_m, .depth_m = depth_m, .sine = sine, .cosine = 0}, {}});
  return nodes;
}

}  // namespace tubefoot
