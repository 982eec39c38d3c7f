// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/water/apparent_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "engine/water/ray_arc.hpp"

// Evaluates the closed forms of ray_arc.hpp with a number that carries its derivatives (forward mode,
// Griewank and Walther, Evaluating Derivatives, 2008, chapter 3). Through several layers, the variable is the
// Snell parameter p, and the implicit function theorem converts derivatives at fixed p to those at fixed
// range.
namespace tubefoot {
namespace {

/// A number with its derivatives. The first variable is the Snell parameter or the range.
struct RayNumber {
  enum : std::size_t { by_first, by_depth, by_apex, by_change, variables };
  double at = 0;
  std::array<double, variables> by{};

  RayNumber() = default;
  RayNumber(double value) : at(value) {}
  static RayNumber variable(double value, std::size_t which) {
    RayNumber x(value);
    x.by[which] = 1;
    return x;
  }
  /// Returns a function of this number, from the value and the slope of the function.
  RayNumber through(double value, double slope) const {
    RayNumber y(value);
    for (std::size_t k = 0; k < variables; ++k) y.by[k] = slope * by[k];
    return y;
  }
  RayNumber& operator+=(const RayNumber& b) { return *this = *this + b; }
  friend RayNumber operator+(RayNumber a, const RayNumber& b) {
    a.at += b.at;
    for (std::size_t k = 0; k < variables; ++k) a.by[k] += b.by[k];
    return a;
  }
  friend RayNumber operator-(const RayNumber& a) { return a.through(-a.at, -1); }
  friend RayNumber operator-(const RayNumber& a, const RayNumber& b) { return a + -b; }
  friend RayNumber operator*(const RayNumber& a, const RayNumber& b) {
    RayNumber y(a.at * b.at);
    for (std::size_t k = 0; k < variables; ++k) y.by[k] = a.by[k] * b.at + a.at * b.by[k];
    return y;
  }
  friend RayNumber operator/(const RayNumber& a, const RayNumber& b) {
    RayNumber y(a.at / b.at);
    for (std::size_t k = 0; k < variables; ++k) y.by[k] = (a.by[k] - y.at * b.by[k]) / b.at;
    return y;
  }

  friend RayNumber squared(const RayNumber& x) { return x * x; }
  friend RayNumber root(const RayNumber& x) {
    const double value = std::sqrt(x.at);
    return x.through(value, 0.5 / value);
  }
  friend RayNumber logarithm(const RayNumber& x) { return x.through(std::log(x.at), 1 / x.at); }
  friend RayNumber log1p_ratio(const RayNumber& v) {
    const double value = log1p_ratio(v.at);
    if (std::abs(v.at) > 0.01) return v.through(value, (1 / (1 + v.at) - value) / v.at);
    double slope = 0;
    for (int k = 9; k >= 1; --k) slope = double(k) / (k + 1) * (k % 2 == 1 ? -1 : 1) + v.at * slope;
    return v.through(value, slope);
  }
};

/// asin(q) / q as a function of q^2; for `sign` = -1, asinh(q) / q.
RayNumber arc_ratio(const RayNumber& q2, int sign) {
  const double v = sign * q2.at;
  if (v * sign > 1e-3) {
    const double q = std::sqrt(q2.at), value = (sign > 0 ? std::asin(q) : std::asinh(q)) / q;
    return q2.through(value, (1 / std::sqrt(1 - v) - value) / (2 * q2.at));
  }
  const double value = 1 + v * (1. / 6 + v * (3. / 40 + v * (15. / 336 + v * 105. / 3456))),
               slope = 1. / 6 + v * (3. / 20 + v * (45. / 336 + v * (420. / 3456 + v * 4725. / 42240)));
  return q2.through(value, sign * slope);
}

/// The profile as a function of depth and of a change of its points.
class MovingProfile {
 public:
  MovingProfile(const SoundSpeedProfile& profile, const std::vector<double>* change)
      : profile_(profile), change_(change != nullptr && !change->empty() ? change : nullptr) {}

  RayNumber gradient(std::size_t layer) const {
    RayNumber g(profile_.gradient_per_s(layer));
    g.by[RayNumber::by_change] = gradient_change(layer);
    return g;
  }
  RayNumber speed(std::size_t layer, const RayNumber& depth_m) const {
    RayNumber c = depth_m.through(profile_.speed_in(layer, depth_m.at), profile_.gradient_per_s(layer));
    if (change_ == nullptr) return c;
    const std::size_t above = layer == 0 ? 0 : layer - 1;
    c.by[RayNumber::by_change] += (*change_)[above];
    if (layer > 0)
      c.by[RayNumber::by_change] += gradient_change(layer) * (depth_m.at - profile_.top_m(layer));
    return c;
  }

 private:
  double gradient_change(std::size_t layer) const {
    if (change_ == nullptr || layer == 0 || layer == profile_.points().size()) return 0;
    return ((*change_)[layer] - (*change_)[layer - 1]) / (profile_.bottom_m(layer) - profile_.top_m(layer));
  }

  const SoundSpeedProfile& profile_;
  const std::vector<double>* change_;
};

/// A ray with derivatives at fixed range.
struct MovingRay {
  RayNumber time, launch_across, launch_down, arrival_across, arrival_down, area, absorption_db;
  double length_m = 0;
  RayNumber launch_speed, arrival_speed;
};

struct RayEnds {
  double source_m, depth_m, range_m;
};

/// An arc of one gradient in closed form, see EigenrayFinder::within_layer().
MovingRay within_layer(const WaterColumn& water, const MovingProfile& profile, std::size_t layer,
                       const RayEnds& ends) {
  const RayNumber x = RayNumber::variable(ends.range_m, RayNumber::by_first),
                  z = RayNumber::variable(ends.depth_m, RayNumber::by_depth),
                  source = RayNumber::variable(ends.source_m, RayNumber::by_apex);
  const RayNumber g = profile.gradient(layer), cs = profile.speed(layer, source),
                  cr = profile.speed(layer, z), dz = z - source, chord = root(squared(x) + squared(dz)),
                  half = root(squared(cs + cr) + squared(g * x)), straight = (cs + cr) / half,
                  tilt = g / half, sine = dz / chord, y2 = squared(g * chord) / (4 * cs * cr);
  MovingRay ray;
  ray.launch_across = straight / chord - sine * tilt;
  ray.launch_down = sine * straight + squared(x) / chord * tilt;
  ray.arrival_across = straight / chord + sine * tilt;
  ray.arrival_down = sine * straight - squared(x) / chord * tilt;
  ray.time = chord / root(cs * cr) * arc_ratio(y2, -1);
  ray.area = cr / cs * squared(chord) * (1 + y2);
  const RayNumber length = chord * arc_ratio(squared(tilt * x), 1);
  ray.absorption_db = water.absorption_in(layer) * length;
  ray.length_m = length.at;
  ray.launch_speed = cs;
  ray.arrival_speed = cr;
  return ray;
}

/// Follows a ray through its layers, at a fixed Snell parameter.
class LayerWalk {
 public:
  LayerWalk(const WaterColumn& water, const MovingProfile& profile, const RayEnds& ends, const Eigenray& ray)
      : water_(water),
        profile_(profile),
        ends_(ends),
        ray_{water.profile.at(ends.source_m), std::abs(ray.launch_sine), ray.launch_cosine},
        p_(RayNumber::variable(ray_.p(), RayNumber::by_first)) {}

  /// Returns false if the ray does not lead to the end point, because a decision was within rounding.
  bool follow(bool down, int turns) {
    const SoundSpeedProfile& layers = water_.profile;
    std::size_t layer = layers.layer_at(ends_.source_m);
    RayNumber z = RayNumber::variable(ends_.source_m, RayNumber::by_apex);
    launch_speed_ = profile_.speed(layer, z);
    launch_sine_ = sine(launch_speed_);
    const RayNumber end = RayNumber::variable(ends_.depth_m, RayNumber::by_depth);
    for (std::size_t steps = 0; steps < 8 * layers.layers() * std::size_t(2 + turns); ++steps) {
      const auto ahead_m = [&] { return down ? layers.bottom_m(layer) : layers.top_m(layer); };
      const auto ends_here = [&] {
        return turns == 0 && (down ? ends_.depth_m <= ahead_m() : ends_.depth_m >= ahead_m());
      };
      const double g = layers.gradient_per_s(layer);
      const RayNumber c1 = profile_.speed(layer, z);
      const bool turning =
          turns > 0 && (down ? g > 0 : g < 0) && ray_.sine2_at(layers.speed_in(layer, ahead_m())) <= 0;
      if (turning) {
        down = !down;
        --turns;
      }
      const bool last = ends_here();
      if (!last && std::isinf(ahead_m())) return false;
      const RayNumber to = last ? end : RayNumber(ahead_m()), c2 = profile_.speed(layer, to);
      turning ? turn(layer, c1, c2) : cross(layer, down ? to - z : z - to, c1, c2);
      if (last) {
        arrival_speed_ = c2;
        arrival_sine_ = sine(c2);
        down_at_end_ = down;
        return true;
      }
      z = to;
      if (!down && layer == 0) return false;
      down ? ++layer : --layer;
      if (layer >= layers.layers()) return false;
    }
    return false;
  }

  MovingRay ray(bool launched_down) const {
    MovingRay ray;
    ray.time = time_;
    ray.launch_across = launch_speed_ / reach_;
    ray.launch_down = launched_down ? launch_sine_ : -launch_sine_;
    ray.arrival_across = arrival_speed_ / reach_;
    ray.arrival_down = down_at_end_ ? arrival_sine_ : -arrival_sine_;
    const RayNumber spread = dx_dp_.at < 0 ? -dx_dp_ : dx_dp_;
    ray.area = reach_ * launch_sine_ * arrival_sine_ * spread / squared(launch_speed_);
    ray.absorption_db = absorption_db_;
    ray.length_m = length_m_;
    ray.launch_speed = launch_speed_;
    ray.arrival_speed = arrival_speed_;
    const RayNumber x = p_ * reach_;
    for (RayNumber* value : {&ray.time, &ray.launch_across, &ray.launch_down, &ray.arrival_across,
                             &ray.arrival_down, &ray.area, &ray.absorption_db}) {
      const double by_range = value->by[RayNumber::by_first] / x.by[RayNumber::by_first];
      value->by[RayNumber::by_first] = by_range;
      for (const std::size_t k : {RayNumber::by_depth, RayNumber::by_apex, RayNumber::by_change})
        value->by[k] -= by_range * x.by[k];
    }
    return ray;
  }

 private:
  RayNumber sine(const RayNumber& c) const {
    RayNumber s(ray_.sine_at(c.at));
    const RayNumber cosine = p_ * c;
    for (std::size_t k = 0; k < RayNumber::variables; ++k) s.by[k] = -cosine.at * cosine.by[k] / s.at;
    return s;
  }
  // The formulas of arc_reach(), arc_dx_dp(), arc_time_s() and arc_length_m().
  void cross(std::size_t layer, const RayNumber& dz, const RayNumber& c1, const RayNumber& c2) {
    const RayNumber s1 = sine(c1), s2 = sine(c2), per_dz = (c1 + c2) / (s1 + s2), reach = dz * per_dz;
    const RayNumber slope = squared(p_) * per_dz / (1 + s2);
    const RayNumber chord = dz * root(1 + squared(p_ * per_dz)),
                    sag = chord * p_ * profile_.gradient(layer) / 2;
    reach_ += reach;
    dx_dp_ += reach / (s1 * s2);
    time_ += dz * (log1p_ratio((c2 - c1) / c1) / c1 + slope * log1p_ratio((c2 - c1) * slope));
    add_length(layer, chord * arc_ratio(squared(sag), 1));
  }
  // The formulas of turning_arc().
  void turn(std::size_t layer, const RayNumber& c1, const RayNumber& c2) {
    const RayNumber s1 = sine(c1), s2 = sine(c2), signed_g = profile_.gradient(layer),
                    g = signed_g.at < 0 ? -signed_g : signed_g, reach = (s1 + s2) / (squared(p_) * g);
    const auto atanh = [](const RayNumber& s) {
      return s.through(std::atanh(s.at), 1 / ((1 - s.at) * (1 + s.at)));
    };
    const auto asin = [](const RayNumber& s) {
      return s.through(std::asin(s.at), 1 / std::sqrt((1 - s.at) * (1 + s.at)));
    };
    reach_ += reach;
    dx_dp_ += -(reach / (s1 * s2));
    time_ += (atanh(s1) + atanh(s2)) / g;
    add_length(layer, (asin(s1) + asin(s2)) / (p_ * g));
  }
  void add_length(std::size_t layer, const RayNumber& length) {
    absorption_db_ += water_.absorption_in(layer) * length;
    length_m_ += length.at;
  }

  const WaterColumn& water_;
  const MovingProfile& profile_;
  RayEnds ends_;
  SnellRay ray_;
  RayNumber p_, reach_, dx_dp_, time_, absorption_db_, launch_speed_, launch_sine_, arrival_speed_,
      arrival_sine_;
  double length_m_ = 0;
  bool down_at_end_ = true;
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

MovingRay moving_ray(const WaterColumn& water, const MovingProfile& profile, const RayEnds& ends,
                     const Eigenray& ray) {
  const std::size_t layer = water.profile.layer_at(ends.source_m);
  if (stays_in_layer(water.profile, layer, ends, ray)) return within_layer(water, profile, layer, ends);
  LayerWalk walk(water, profile, ends, ray);
  const bool down = ray.launch_sine > 0;
  MovingRay moving;
  if (walk.follow(down, ray.turns)) moving = walk.ray(down);
  constexpr double same = 1e-9;
  if (!(std::abs(moving.time.at - ray.time_s) <= same * ray.time_s))
    moving.time.at = std::numeric_limits<double>::quiet_NaN();
  return moving;
}

constexpr double nepers_per_db = std::numbers::ln10 / 10;

}  // namespace

ApparentMotion::ApparentMotion(const ApparentMap& apparent_map, glm::dvec3 point_m,
                               const ApparentPoint& image, std::span<const WaterChange> changes)
    : along_(point_m - apparent_map.apex_m()),
      range_m_(std::hypot(along_.x, along_.y)),
      reference_speed_(apparent_map.reference_speed_m_s()) {
  if (apparent_map.unfolding().sign != 1 || apparent_map.straight_within_m() > 0)
    throw std::invalid_argument("derivatives of apparent positions need a path without mirrors");
  const WaterColumn& water = apparent_map.water();
  const RayEnds ends{apparent_map.finder().source_depth_m(), apparent_map.depth_m(point_m), range_m_};
  bool known = false;
  for (std::size_t k = 0; k < std::max<std::size_t>(changes.size(), 1); ++k) {
    const WaterChange* change = changes.empty() ? nullptr : &changes[k];
    const bool moves = change != nullptr && !change->sound_speed_m_s.empty();
    if (moves && change->sound_speed_m_s.size() != water.profile.points().size())
      throw std::invalid_argument("a change of the sound speed needs one number per point of the profile");
    Values own{};
    if (moves || !known) {
      const MovingRay ray =
          moving_ray(water, {water.profile, moves ? &change->sound_speed_m_s : nullptr}, ends, image.ray);
      const RayNumber log_density = -2 * nepers_per_db * ray.absorption_db - 2 * logarithm(ray.area) -
                                    2 * (logarithm(ray.launch_speed) - logarithm(ray.arrival_speed));
      const std::array<RayNumber, count> all{ray.time,           ray.launch_across, ray.launch_down,
                                             ray.arrival_across, ray.arrival_down,  log_density};
      for (std::size_t n = 0; n < count; ++n) {
        at_[n] = std::isfinite(ray.time.at) ? all[n].at : ray.time.at;
        by_range_[n] = range_m_ > 0 ? all[n].by[RayNumber::by_first] : 0;
        by_depth_[n] = all[n].by[RayNumber::by_depth];
        by_apex_[n] = all[n].by[RayNumber::by_apex];
        own[n] = all[n].by[RayNumber::by_change];
      }
      known = true;
    }
    if (change == nullptr) continue;
    own[density] -= 2 * nepers_per_db * change->absorption_db_per_m * image.ray.length_m;
    by_change_.push_back(own);
  }
}

ApparentMotion::Velocity ApparentMotion::of(glm::dvec3 point, glm::dvec3 apex, std::size_t change) const {
  const glm::dvec3 moved = point - apex;
  const double range = range_m_ > 0 ? (along_.x * moved.x + along_.y * moved.y) / range_m_ : 0;
  Values by{};
  for (std::size_t n = 0; n < count; ++n) {
    by[n] = by_range_[n] * range - by_depth_[n] * point.z - by_apex_[n] * apex.z;
    if (change != no_change) by[n] += by_change_[change][n];
    by[n] += 0 * at_[n];  // not finite without a ray
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
