// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/water/apparent_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "engine/water/ray_arc.hpp"
#include "geometry/numbers/dual.hpp"

// Evaluates the closed forms of ray_arc.hpp with a number that carries its derivatives (forward mode,
// Griewank and Walther, Evaluating Derivatives, 2008, chapter 3). Through several layers, the variable is the
// Snell parameter p, and the implicit function theorem converts derivatives at fixed p to those at fixed
// range.
namespace tubefoot {
namespace {

/// Variables of a ray. The first one is the Snell parameter or the range. The last two are the sound speeds
/// of the points of the profile above and below a layer.
enum RayVariable : std::size_t { by_first, by_depth, by_apex, by_upper, by_lower, ray_variables };
using RayNumber = Dual<ray_variables>;

RayNumber logarithm(const RayNumber& x) { return x.through(std::log(x.value), 1 / x.value); }
RayNumber moving_log1p_ratio(const RayNumber& v) {
  const double value = log1p_ratio(v.value);
  if (std::abs(v.value) > 0.01) return v.through(value, (1 / (1 + v.value) - value) / v.value);
  double slope = 0;
  for (int k = 9; k >= 1; --k) slope = double(k) / (k + 1) * (k % 2 == 1 ? -1 : 1) + v.value * slope;
  return v.through(value, slope);
}

/// asin(q) / q as a function of q^2; for `sign` = -1, asinh(q) / q.
RayNumber arc_ratio(const RayNumber& q2, int sign) {
  const double v = sign * q2.value;
  if (v * sign > 1e-3) {
    const double q = std::sqrt(q2.value), value = (sign > 0 ? std::asin(q) : std::asinh(q)) / q;
    return q2.through(value, (1 / std::sqrt(1 - v) - value) / (2 * q2.value));
  }
  const double value = 1 + v * (1. / 6 + v * (3. / 40 + v * (15. / 336 + v * 105. / 3456))),
               slope = 1. / 6 + v * (3. / 20 + v * (45. / 336 + v * (420. / 3456 + v * 4725. / 42240)));
  return q2.through(value, sign * slope);
}

/// The profile in one layer as a function of depth and of its two points.
class MovingLayer {
 public:
  MovingLayer(const SoundSpeedProfile& profile, std::size_t layer) : profile_(profile), layer_(layer) {}

  bool has_upper() const { return layer_ > 0; }
  bool has_lower() const { return layer_ < profile_.points().size(); }
  RayNumber gradient() const {
    RayNumber g(profile_.gradient_per_s(layer_));
    if (!has_upper() || !has_lower()) return g;
    g.derivative[by_lower] = 1 / (profile_.bottom_m(layer_) - profile_.top_m(layer_));
    g.derivative[by_upper] = -g.derivative[by_lower];
    return g;
  }
  RayNumber speed(const RayNumber& depth_m) const {
    RayNumber c = depth_m.through(profile_.speed_in(layer_, depth_m.value), profile_.gradient_per_s(layer_));
    double share = has_upper() ? 0 : 1;  // of the lower point
    if (has_upper() && has_lower())
      share = (depth_m.value - profile_.top_m(layer_)) / (profile_.bottom_m(layer_) - profile_.top_m(layer_));
    c.derivative[by_upper] += 1 - share;
    c.derivative[by_lower] += share;
    return c;
  }

 private:
  const SoundSpeedProfile& profile_;
  std::size_t layer_;
};

/// A ray with derivatives at fixed range.
struct MovingRay {
  RayNumber time, launch_across, launch_down, arrival_across, arrival_down, area, absorption_db;
  RayNumber launch_speed, arrival_speed;
};

struct RayEnds {
  double source_m, depth_m, range_m;
};

/// An arc of one gradient in closed form, see EigenrayFinder::within_layer().
MovingRay within_layer(const WaterColumn& water, std::size_t layer, const RayEnds& ends) {
  const MovingLayer profile(water.profile, layer);
  const RayNumber x = RayNumber::parameter(ends.range_m, by_first),
                  z = RayNumber::parameter(ends.depth_m, by_depth),
                  source = RayNumber::parameter(ends.source_m, by_apex);
  const RayNumber g = profile.gradient(), cs = profile.speed(source), cr = profile.speed(z), dz = z - source,
                  chord = root(squared(x) + squared(dz)), half = root(squared(cs + cr) + squared(g * x)),
                  straight = (cs + cr) / half, tilt = g / half, sine = dz / chord,
                  y2 = squared(g * chord) / (4 * cs * cr);
  MovingRay ray;
  ray.launch_across = straight / chord - sine * tilt;
  ray.launch_down = sine * straight + squared(x) / chord * tilt;
  ray.arrival_across = straight / chord + sine * tilt;
  ray.arrival_down = sine * straight - squared(x) / chord * tilt;
  ray.time = chord / root(cs * cr) * arc_ratio(y2, -1);
  ray.area = cr / cs * squared(chord) * (1 + y2);
  ray.absorption_db = water.absorption_in(layer) * chord * arc_ratio(squared(tilt * x), 1);
  ray.launch_speed = cs;
  ray.arrival_speed = cr;
  return ray;
}

/// Follows a ray through its layers, at a fixed Snell parameter.
class LayerWalk {
 public:
  LayerWalk(const WaterColumn& water, const RayEnds& ends, const Eigenray& ray)
      : water_(water),
        ends_(ends),
        ray_{water.profile.at(ends.source_m), std::abs(ray.launch_sine), ray.launch_cosine},
        launched_down_(ray.launch_sine > 0),
        p_(RayNumber::parameter(ray_.p(), by_first)) {}

  /// Returns false if the ray does not lead to the end point, because a decision was within rounding.
  bool follow(int turns) {
    const SoundSpeedProfile& layers = water_.profile;
    bool down = launched_down_;
    std::size_t layer = layers.layer_at(ends_.source_m);
    RayNumber z = RayNumber::parameter(ends_.source_m, by_apex);
    launch_ = {layer, MovingLayer(layers, layer).speed(z), {}, down};
    launch_.sine = sine(launch_.speed);
    const RayNumber end = RayNumber::parameter(ends_.depth_m, by_depth);
    for (std::size_t steps = 0; steps < 8 * layers.layers() * std::size_t(2 + turns); ++steps) {
      const auto ahead_m = [&] { return down ? layers.bottom_m(layer) : layers.top_m(layer); };
      const auto ends_here = [&] {
        return turns == 0 && (down ? ends_.depth_m <= ahead_m() : ends_.depth_m >= ahead_m());
      };
      const MovingLayer profile(layers, layer);
      const double g = layers.gradient_per_s(layer);
      const RayNumber c1 = profile.speed(z);
      const bool turning =
          turns > 0 && (down ? g > 0 : g < 0) && ray_.sine2_at(layers.speed_in(layer, ahead_m())) <= 0;
      if (turning) {
        down = !down;
        --turns;
      }
      const bool last = ends_here();
      if (!last && std::isinf(ahead_m())) return false;
      const RayNumber to = last ? end : RayNumber(ahead_m()), c2 = profile.speed(to);
      add(layer, turning ? turn(profile, c1, c2) : cross(profile, down ? to - z : z - to, c1, c2));
      if (last) {
        arrival_ = {layer, c2, sine(c2), down};
        return true;
      }
      z = to;
      if (!down && layer == 0) return false;
      down ? ++layer : --layer;
      if (layer >= layers.layers()) return false;
    }
    return false;
  }

  /// The ray, whose variable by_upper is the sound speed of a point of the profile.
  MovingRay ray(std::size_t point) const {
    const Legs sums = sums_by(point);
    const RayNumber launch_speed = by_point(launch_, launch_.speed, point),
                    launch_sine = by_point(launch_, launch_.sine, point),
                    arrival_speed = by_point(arrival_, arrival_.speed, point),
                    arrival_sine = by_point(arrival_, arrival_.sine, point);
    MovingRay ray;
    ray.time = sums.time;
    ray.launch_across = launch_speed / sums.reach;
    ray.launch_down = launch_.down ? launch_sine : -launch_sine;
    ray.arrival_across = arrival_speed / sums.reach;
    ray.arrival_down = arrival_.down ? arrival_sine : -arrival_sine;
    const RayNumber spread = sums.dx_dp.value < 0 ? -sums.dx_dp : sums.dx_dp;
    ray.area = sums.reach * launch_sine * arrival_sine * spread / squared(launch_speed);
    ray.absorption_db = sums.absorption_db;
    ray.launch_speed = launch_speed;
    ray.arrival_speed = arrival_speed;
    const RayNumber x = p_ * sums.reach;
    for (RayNumber* value : {&ray.time, &ray.launch_across, &ray.launch_down, &ray.arrival_across,
                             &ray.arrival_down, &ray.area, &ray.absorption_db}) {
      const double by_range = value->derivative[by_first] / x.derivative[by_first];
      value->derivative[by_first] = by_range;
      for (const std::size_t k : {by_depth, by_apex, by_upper})
        value->derivative[k] -= by_range * x.derivative[k];
    }
    return ray;
  }

  /// Points of the profile on which the ray depends.
  std::vector<std::size_t> points() const {
    std::vector<std::size_t> all;
    for (const auto& [point, sums] : by_point_) all.push_back(point);
    return all;
  }

 private:
  /// Sums over layers, as in RaySums.
  struct Legs {
    RayNumber reach, dx_dp, time, absorption_db;
    std::array<RayNumber*, 4> all() { return {&reach, &dx_dp, &time, &absorption_db}; }
  };
  struct End {
    std::size_t layer = 0;
    RayNumber speed, sine;
    bool down = true;
  };

  RayNumber sine(const RayNumber& c) const {
    RayNumber s(ray_.sine_at(c.value));
    const RayNumber cosine = p_ * c;
    for (std::size_t k = 0; k < ray_variables; ++k)
      s.derivative[k] = -cosine.value * cosine.derivative[k] / s.value;
    return s;
  }
  // The formulas of arc_reach(), arc_dx_dp(), arc_time_s() and arc_length_m(). `absorption_db` contains the
  // length.
  Legs cross(const MovingLayer& profile, const RayNumber& dz, const RayNumber& c1,
             const RayNumber& c2) const {
    const RayNumber s1 = sine(c1), s2 = sine(c2), per_dz = (c1 + c2) / (s1 + s2), reach = dz * per_dz;
    const RayNumber slope = squared(p_) * per_dz / (1 + s2);
    const RayNumber chord = dz * root(1 + squared(p_ * per_dz)), sag = chord * p_ * profile.gradient() / 2;
    return {reach, reach / (s1 * s2),
            dz * (moving_log1p_ratio((c2 - c1) / c1) / c1 + slope * moving_log1p_ratio((c2 - c1) * slope)),
            chord * arc_ratio(squared(sag), 1)};
  }
  // The formulas of turning_arc().
  Legs turn(const MovingLayer& profile, const RayNumber& c1, const RayNumber& c2) const {
    const RayNumber s1 = sine(c1), s2 = sine(c2), signed_g = profile.gradient(),
                    g = signed_g.value < 0 ? -signed_g : signed_g, reach = (s1 + s2) / (squared(p_) * g);
    const auto atanh = [](const RayNumber& s) {
      return s.through(std::atanh(s.value), 1 / ((1 - s.value) * (1 + s.value)));
    };
    const auto asin = [](const RayNumber& s) {
      return s.through(std::asin(s.value), 1 / std::sqrt((1 - s.value) * (1 + s.value)));
    };
    return {reach, -(reach / (s1 * s2)), (atanh(s1) + atanh(s2)) / g, (asin(s1) + asin(s2)) / (p_ * g)};
  }
  void add(std::size_t layer, Legs leg) {
    leg.absorption_db = water_.absorption_in(layer) * leg.absorption_db;
    const MovingLayer profile(water_.profile, layer);
    for (std::size_t k = 0; k < 4; ++k) {
      RayNumber& value = *leg.all()[k];
      if (profile.has_upper()) by_point_[layer - 1][k] += value.derivative[by_upper];
      if (profile.has_lower()) by_point_[layer][k] += value.derivative[by_lower];
      value.derivative[by_upper] = value.derivative[by_lower] = 0;
      *sums_.all()[k] += value;
    }
  }
  Legs sums_by(std::size_t point) const {
    Legs sums = sums_;
    if (const auto known = by_point_.find(point); known != by_point_.end())
      for (std::size_t k = 0; k < 4; ++k) sums.all()[k]->derivative[by_upper] = known->second[k];
    return sums;
  }
  static RayNumber by_point(const End& end, RayNumber value, std::size_t point) {
    const double by = (point + 1 == end.layer ? value.derivative[by_upper] : 0) +
                      (point == end.layer ? value.derivative[by_lower] : 0);
    value.derivative[by_upper] = by;
    value.derivative[by_lower] = 0;
    return value;
  }

  const WaterColumn& water_;
  RayEnds ends_;
  SnellRay ray_;
  bool launched_down_;
  RayNumber p_;
  Legs sums_;
  std::map<std::size_t, std::array<double, 4>> by_point_;
  End launch_, arrival_;
};

/// Returns whether the ray stays in the layer of the source. A source on a border belongs to the layer below.
bool stays_in_layer(const SoundSpeedProfile& profile, std::size_t layer, const RayEnds& ends,
                    const Eigenray& ray) {
  if (!(ends.depth_m >= profile.top_m(layer) && ends.depth_m <= profile.bottom_m(layer))) return false;
  if (ray.turns == 0) return true;
  if (ray.turns > 1) return false;
  const double ahead_m = ray.launch_sine > 0 ? profile.bottom_m(layer) : profile.top_m(layer);
  const SnellRay snell{profile.at(ends.source_m), std::abs(ray.launch_sine), ray.launch_cosine};
  return std::isfinite(ahead_m) && snell.sine2_at(profile.speed_in(layer, ahead_m)) <= 0;
}

constexpr double nepers_per_db = std::numbers::ln10 / 10;

RayNumber log_density_of(const MovingRay& ray) {
  return -2 * nepers_per_db * ray.absorption_db - 2 * logarithm(ray.area) -
         2 * (logarithm(ray.launch_speed) - logarithm(ray.arrival_speed));
}

}  // namespace

std::vector<ApparentMotion::Effect> ApparentMotion::trace(const ApparentMap& apparent_map, glm::dvec3 point_m,
                                                          const ApparentPoint& image, bool by_points) {
  along_ = point_m - apparent_map.apex_m();
  range_m_ = std::hypot(along_.x, along_.y);
  reference_speed_ = apparent_map.reference_speed_m_s();
  if (apparent_map.unfolding().sign != 1 || apparent_map.straight_within_m() > 0)
    throw std::invalid_argument("derivatives of apparent positions need a path without mirrors");
  const WaterColumn& water = apparent_map.water();
  const RayEnds ends{apparent_map.finder().source_depth_m(), apparent_map.depth_m(point_m), range_m_};
  const auto slopes = [](const MovingRay& ray, std::size_t variable) {
    return Values{ray.time.derivative[variable],         ray.launch_across.derivative[variable],
                  ray.launch_down.derivative[variable],  ray.arrival_across.derivative[variable],
                  ray.arrival_down.derivative[variable], log_density_of(ray).derivative[variable]};
  };
  std::vector<Effect> by_point;
  MovingRay ray;
  const std::size_t layer = water.profile.layer_at(ends.source_m);
  bool found = true;
  if (stays_in_layer(water.profile, layer, ends, image.ray)) {
    ray = within_layer(water, layer, ends);
    const MovingLayer own(water.profile, layer);
    if (own.has_upper()) by_point.emplace_back(layer - 1, slopes(ray, by_upper));
    if (own.has_lower()) by_point.emplace_back(layer, slopes(ray, by_lower));
  } else {
    LayerWalk walk(water, ends, image.ray);
    found = walk.follow(image.ray.turns);
    if (found) ray = walk.ray(water.profile.layers());  // no point
    if (found && by_points)
      for (const std::size_t point : walk.points())
        by_point.emplace_back(point, slopes(walk.ray(point), by_upper));
  }
  constexpr double same = 1e-9;
  if (!found || !(std::abs(ray.time.value - image.ray.time_s) <= same * image.ray.time_s))
    ray.time.value = std::numeric_limits<double>::quiet_NaN();
  at_ = {ray.time.value,           ray.launch_across.value, ray.launch_down.value,
         ray.arrival_across.value, ray.arrival_down.value,  0};
  if (range_m_ > 0) by_range_ = slopes(ray, by_first);
  by_depth_ = slopes(ray, by_depth);
  by_apex_ = slopes(ray, by_apex);
  return by_point;
}

ApparentMotion::ApparentMotion(const ApparentMap& apparent_map, glm::dvec3 point_m,
                               const ApparentPoint& image, std::span<const WaterChange> changes) {
  const std::vector<Effect> by_point =
      trace(apparent_map, point_m, image, std::ranges::any_of(changes, [](const WaterChange& change) {
              return !change.sound_speed_m_s.empty();
            }));
  for (const WaterChange& change : changes) {
    const std::vector<double>& speeds = change.sound_speed_m_s;
    if (!speeds.empty() && speeds.size() != apparent_map.water().profile.points().size())
      throw std::invalid_argument("a change of the sound speed needs one number per point of the profile");
    Values own{};
    own[density] = -2 * nepers_per_db * change.absorption_db_per_m * image.ray.length_m;
    for (const auto& [point, by] : by_point)
      for (std::size_t n = 0; n < count && !speeds.empty(); ++n) own[n] += speeds[point] * by[n];
    effects_.emplace_back(effects_.size(), own);
  }
}

ApparentMotion::ApparentMotion(const ApparentMap& apparent_map, glm::dvec3 point_m,
                               const ApparentPoint& image, ByProfilePoint)
    : effects_(trace(apparent_map, point_m, image, true)) {
  std::ranges::sort(effects_, {}, &Effect::first);
  Values absorbed{};
  absorbed[density] = -2 * nepers_per_db * image.ray.length_m;
  effects_.emplace_back(apparent_map.water().profile.points().size(), absorbed);
}

ApparentMotion::Velocity ApparentMotion::of(glm::dvec3 point, glm::dvec3 apex, std::size_t change) const {
  const glm::dvec3 moved = point - apex;
  const double range = range_m_ > 0 ? (along_.x * moved.x + along_.y * moved.y) / range_m_ : 0;
  Values by{};
  const auto effect = std::ranges::lower_bound(effects_, change, {}, &Effect::first);
  const bool changes = effect != effects_.end() && effect->first == change;
  for (std::size_t n = 0; n < count; ++n) {
    by[n] = by_range_[n] * range - by_depth_[n] * point.z - by_apex_[n] * apex.z;
    if (changes) by[n] += effect->second[n];
    by[n] += 0 * at_[time];  // not finite without a ray
  }
  const double across = reference_speed_ * (by[time] * at_[launch_across] + at_[time] * by[launch_across]),
               moves = reference_speed_ * at_[time] * at_[launch_across],
               down = reference_speed_ * (by[time] * at_[launch_down] + at_[time] * by[launch_down]);
  const double turned = by[arrival_across], kept = at_[arrival_across];
  return {{across * along_.x + moves * moved.x, across * along_.y + moves * moved.y, -down},
          {turned * along_.x + kept * moved.x, turned * along_.y + kept * moved.y, -by[arrival_down]},
          by[density]};
}

}  // namespace tubefoot
