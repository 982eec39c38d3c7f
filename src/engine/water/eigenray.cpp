// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/water/eigenray.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <numbers>
#include <span>
#include <stdexcept>
#include <tuple>

// Finds eigenrays in layers of constant sound-speed gradient, as eigenray.hpp describes. Range, time, length
// and tube area are sums of closed forms per layer (ray_arc.hpp). The Airy width at caustics follows Jensen,
// Kuperman, Porter & Schmidt, Computational Ocean Acoustics (2011), section 3, and DLMF 9.9.
namespace tubefoot {
namespace {

constexpr std::size_t kNoLayer = std::numeric_limits<std::size_t>::max();

/// Returns a root of a continuous function that changes its sign between a and b, accurate to the last
/// digits.
template <class Function>
double root_between(const Function& f, double a, double b, double fa, double fb) {
  if (fa == 0) return a;
  if (fb == 0) return b;
  std::uintmax_t most = 100;
  const auto close = [](double u, double v) { return std::abs(v - u) <= 4e-16 * std::abs(u + v); };
  const auto [lo, hi] = boost::math::tools::toms748_solve(f, a, b, fa, fb, close, most);
  return (lo + hi) / 2;
}

}  // namespace

/// Layers between source and point, above the upper of the two, and below the lower one.
struct EigenrayFinder::Section {
  std::vector<Piece> between, above, below;
  std::size_t common_layer = kNoLayer;  // of source and point
};

/// An order of turning points: how often a ray passes each part of the section.
struct EigenrayFinder::Order {
  bool launched_up = false;
  int turns = 0;
  int between = 0, above = 0, below = 0;
};

/// Whole layers from the source on, and part of the layer that contains the point.
struct EigenrayFinder::RayPath {
  std::span<const Piece> whole;
  Piece part;
  double fastest, mean_speed;

  std::size_t size() const { return whole.size() + 1; }
  const Piece& operator[](std::size_t i) const { return i < whole.size() ? whole[i] : part; }
};

EigenrayFinder::EigenrayFinder(const WaterColumn& water, double source_depth_m,
                               const EigenrayOptions& options)
    : water_(water),
      options_(options),
      source_m_(source_depth_m),
      source_speed_(water.profile.at(source_m_)) {
  if (!(source_m_ >= options_.surface_m) || !std::isfinite(source_m_))
    throw std::invalid_argument(
        fmt::format("a source at a depth of {} m lies above the water surface", source_depth_m));
  const std::vector<ProfilePoint>& points = water.profile.points();
  up_ = pieces_up(source_m_, points.front().depth_m);
  down_ = pieces(source_m_, points.back().depth_m);
  for (auto [path, fastest, crossed] :
       {std::tuple(&up_, &fastest_up_, &crossed_up_), std::tuple(&down_, &fastest_down_, &crossed_down_)}) {
    double c = source_speed_, sum = 0;
    for (const Piece& piece : *path) {
      fastest->push_back(c = std::max(c, piece.c2));
      crossed->push_back(sum += piece.dz_m * (piece.c1 + piece.c2) / 2);
    }
  }
  double slowest = source_speed_, fastest = source_speed_;
  for (const ProfilePoint& p : points) {
    slowest = std::min(slowest, p.sound_speed_m_s);
    fastest = std::max(fastest, p.sound_speed_m_s);
  }
  steepest_turning_ = std::sqrt((fastest - slowest) * (fastest + slowest)) / slowest;
  // The outermost layers are isovelocity, so no ray turns in them.
  const double shallowest = std::max(options_.surface_m, points.front().depth_m);
  const double deepest = std::min(options_.deepest_turn_m, points.back().depth_m);
  const std::vector<Piece> above = pieces_up(source_m_, shallowest), below = pieces(source_m_, deepest);
  launched_up_ = coming_back(above, below);
  launched_down_ = coming_back(below, above);
}

// A ray that turns at a sound speed between a and b crosses every layer less steeply than the ray that turns
// at b. It reaches at least the depth at which the sound speed is a.
EigenrayFinder::ComingBack EigenrayFinder::coming_back(const std::vector<Piece>& away,
                                                       const std::vector<Piece>& on) const {
  constexpr int speeds = 32, depths = 32;
  constexpr double none = std::numeric_limits<double>::infinity(), rounding = 1 - 1e-9;
  ComingBack result;
  result.fastest = source_speed_;
  for (const Piece& piece : away) result.fastest = std::max(result.fastest, piece.c2);
  double way_m = 0;
  for (const Piece& piece : on) way_m += piece.dz_m;
  result.least_m.assign(way_m > 0 ? depths : 1, none);
  if (way_m > 0) result.step_m = way_m / depths;
  if (!(result.fastest > source_speed_)) return result;
  const auto note = [&](double m, double range_m) {
    double& least = result.least_m[static_cast<std::size_t>(m)];
    least = std::min(least, range_m * rounding);
  };
  for (int i = 0; i < speeds; ++i) {
    const auto speed = [&](int k) { return source_speed_ + (result.fastest - source_speed_) * k / speeds; };
    const double a = speed(i);
    const SnellRay steep{speed(i + 1), 0, 1};
    const auto range_over = [&steep](double dz_m, double c1, double c2) {
      return steep.p() * arc_reach(dz_m, c1, c2, steep.sine_at(c1), steep.sine_at(c2));
    };
    double range_m = 0;
    for (const Piece& piece : away) {
      if (piece.c2 <= a) {
        range_m += 2 * range_over(piece.dz_m, piece.c1, piece.c2);
        continue;
      }
      if (piece.c1 < a)
        range_m += 2 * range_over(piece.dz_m * (a - piece.c1) / (piece.c2 - piece.c1), piece.c1, a);
      break;
    }
    note(0, range_m);
    double from_m = 0;  // start of the piece
    int next = 1;
    for (const Piece& piece : on) {
      if (!(piece.c2 < steep.sound_speed_m_s)) break;  // no ray of this class passes the piece
      for (; next < int(result.least_m.size()) && next * result.step_m <= from_m + piece.dz_m; ++next) {
        const double dz_m = next * result.step_m - from_m;
        note(next,
             range_m + range_over(dz_m, piece.c1, piece.c1 + (piece.c2 - piece.c1) * dz_m / piece.dz_m));
      }
      range_m += range_over(piece.dz_m, piece.c1, piece.c2);
      from_m += piece.dz_m;
    }
    // Only some rays pass the next layer. For these, the bound at its beginning remains valid.
    for (; next < int(result.least_m.size()); ++next) note(next, range_m);
  }
  return result;
}

bool EigenrayFinder::may_turn_towards(double depth_m, double range_m) const {
  // A turning ray is nowhere steeper than a ray that is horizontal at the fastest depth of the profile.
  if (options_.most_turns < 1 || !(range_m > 0) ||
      steeper_than_turning(std::abs(depth_m - source_m_), range_m))
    return false;
  const bool below = depth_m >= source_m_;
  const ComingBack &back = below ? launched_up_ : launched_down_,
                   &beyond = below ? launched_down_ : launched_up_;
  return options_.most_turns > 1 || range_m >= back.least_at(std::abs(depth_m - source_m_)) ||
         beyond.fastest > std::max(source_speed_, water_.profile.at(depth_m));
}

EigenrayFinder::RayPath EigenrayFinder::path_to(double depth_m) const {
  const SoundSpeedProfile& profile = water_.profile;
  const bool up = depth_m < source_m_;
  const std::vector<Piece>& pieces = up ? up_ : down_;
  std::size_t layer = profile.layer_at(depth_m);
  if (!up && depth_m == profile.top_m(layer)) --layer;
  const std::size_t first = pieces.front().layer, whole = up ? first - layer : layer - first;
  const double from_m = up ? profile.bottom_m(layer) : profile.top_m(layer);
  const double g = profile.gradient_per_s(layer), c = profile.speed_in(layer, depth_m);
  RayPath path;
  path.whole = std::span(pieces).first(whole);
  path.part = {std::abs(depth_m - from_m), path.whole.back().c2, c, up ? -g : g, layer};
  path.fastest = std::max((up ? fastest_up_ : fastest_down_)[whole - 1], c);
  path.mean_speed =
      ((up ? crossed_up_ : crossed_down_)[whole - 1] + path.part.dz_m * (path.part.c1 + c) / 2) /
      std::abs(depth_m - source_m_);
  return path;
}

std::vector<EigenrayFinder::Piece> EigenrayFinder::pieces(double top_m, double bottom_m) const {
  const SoundSpeedProfile& profile = water_.profile;
  std::vector<Piece> result;
  for (std::size_t layer = profile.layer_at(top_m); top_m < bottom_m; ++layer) {
    const double end_m = std::min(profile.bottom_m(layer), bottom_m);
    result.push_back({end_m - top_m, profile.speed_in(layer, top_m), profile.speed_in(layer, end_m),
                      profile.gradient_per_s(layer), layer});
    top_m = end_m;
  }
  return result;
}

std::vector<EigenrayFinder::Piece> EigenrayFinder::pieces_up(double from_m, double to_m) const {
  std::vector<Piece> result = pieces(to_m, from_m);
  std::reverse(result.begin(), result.end());
  for (Piece& piece : result) {
    std::swap(piece.c1, piece.c2);
    piece.gradient_per_s = -piece.gradient_per_s;
  }
  return result;
}

std::size_t EigenrayFinder::common_layer(double top_m, double bottom_m) const {
  const SoundSpeedProfile& profile = water_.profile;
  std::size_t layer = profile.layer_at(bottom_m);
  if (layer > 0 && top_m < bottom_m && bottom_m == profile.top_m(layer)) --layer;
  return top_m >= profile.top_m(layer) ? layer : kNoLayer;
}

Eigenray EigenrayFinder::eigenray(const SnellRay& ray, const RaySums& sums, double depth_m, bool launched_up,
                                  int turns) const {
  const double c = water_.profile.at(depth_m), p = ray.p();
  const double sine_s = ray.sine_at(source_speed_), sine_r = ray.sine_at(c);
  const bool arrives_up = launched_up != (turns % 2 == 1);
  Eigenray e;
  e.launch_sine = launched_up ? -sine_s : sine_s;
  e.launch_cosine = p * source_speed_;
  e.arrival_sine = arrives_up ? -sine_r : sine_r;
  e.arrival_cosine = p * c;
  e.time_s = sums.time_s;
  e.length_m = sums.length_m;
  e.absorption_db = sums.absorption_db;
  e.tube_area_m2_per_sr =
      sums.reach * sine_s * sine_r * std::abs(sums.dx_dp) / (source_speed_ * source_speed_);
  e.turns = turns;
  e.crossed = (sums.dx_dp < 0) != (turns % 2 == 1);
  return e;
}

// In a layer with one gradient, the ray's angle at the middle of the chord equals the chord's angle. Along
// the path the ray turns by 2 delta, with tan delta = g x / (c_s + c_r). Both follow from Snell's law at the
// two ends.
std::optional<Eigenray> EigenrayFinder::within_layer(std::size_t layer, double depth_m,
                                                     double range_m) const {
  const SoundSpeedProfile& profile = water_.profile;
  const double g = profile.gradient_per_s(layer);
  const double cs = profile.speed_in(layer, source_m_), cr = profile.speed_in(layer, depth_m);
  const double dz = depth_m - source_m_, x = range_m, chord = std::hypot(x, dz);
  if (chord == 0) return std::nullopt;
  const double half = std::hypot(cs + cr, g * x), tilt = (g * x) / half, straight = (cs + cr) / half;
  const double sine = dz / chord, cosine = x / chord;
  Eigenray e;
  e.launch_sine = sine * straight + cosine * tilt;
  e.launch_cosine = cosine * straight - sine * tilt;
  e.arrival_sine = sine * straight - cosine * tilt;
  e.arrival_cosine = cosine * straight + sine * tilt;
  e.turns = e.launch_sine * e.arrival_sine < 0 ? 1 : 0;
  if (e.turns == 1) {
    // Depth of the turning point. By Snell's law the sound speed there is c / cos.
    const double turn_m =
        source_m_ + cs * e.launch_sine * e.launch_sine / (e.launch_cosine * (1 + e.launch_cosine) * g);
    const bool inside = turn_m >= std::max(profile.top_m(layer), options_.surface_m) &&
                        turn_m <= std::min(profile.bottom_m(layer), options_.deepest_turn_m);
    if (!inside || options_.most_turns < 1) return std::nullopt;
  }
  const double y = std::abs(g) * chord / (2 * std::sqrt(cs * cr));
  e.time_s = y > 0 ? 2 / std::abs(g) * std::asinh(y) : chord / cs;
  const double sag = std::abs(tilt);
  e.length_m = chord * asin_ratio(sag);
  e.tube_area_m2_per_sr = cr / cs * chord * chord * (1 + y * y);
  e.absorption_db = water_.absorption_in(layer) * e.length_m;
  return e;
}

template <class Pieces>
RaySums EigenrayFinder::along(const SnellRay& ray, const Pieces& path, bool times_too) const {
  RaySums sums;
  if (path.size() == 0) return sums;
  const double p = ray.p();
  double s1 = ray.sine_at(path[0].c1);
  for (std::size_t i = 0; i < path.size(); ++i) {
    const Piece& piece = path[i];
    const double s2 = ray.sine_at(piece.c2);
    const double reach = arc_reach(piece.dz_m, piece.c1, piece.c2, s1, s2);
    sums.reach += reach;
    sums.dx_dp += arc_dx_dp(reach, s1, s2);
    if (times_too) {
      const double length = arc_length_m(piece.dz_m, reach, p, piece.gradient_per_s);
      sums.time_s += arc_time_s(piece.dz_m, piece.c1, piece.c2, s1, s2, p);
      sums.length_m += length;
      sums.absorption_db += water_.absorption_in(piece.layer) * length;
    }
    s1 = s2;
  }
  return sums;
}

// Newton's method in q = cosine / sine at the fastest depth. In every layer the range is a concave function
// of q. Steps from the left therefore never pass the root, and each step doubles the number of correct
// digits.
std::optional<Eigenray> EigenrayFinder::through_layers(double depth_m, double range_m) const {
  const RayPath path = path_to(depth_m);
  const double fastest = path.fastest, first = path[0].c1;
  const auto at = [fastest](double q) {
    const double w = 1 / std::sqrt(1 + q * q);
    return SnellRay{fastest, w, q * w};
  };
  // Any start is valid, because one step from the right of the root leads to its left. The start is the ray
  // whose angle equals that of the straight line where the sound speed has its mean value.
  const double flat = fastest / path.mean_speed * range_m / std::hypot(range_m, depth_m - source_m_);
  double q = flat < 1 ? flat / std::sqrt((1 - flat) * (1 + flat)) : 0;
  bool range_checked = false;
  for (int step = 0; range_m > 0 && step < 200; ++step) {
    const SnellRay ray = at(q);
    double reach = 0, dx_dp = 0, s1 = ray.sine_at(first);
    for (std::size_t i = 0; i < path.size(); ++i) {
      const Piece& piece = path[i];
      const double s2 = ray.sine_at(piece.c2);
      const double r = arc_reach(piece.dz_m, piece.c1, piece.c2, s1, s2);
      reach += r;
      dx_dp += arc_dx_dp(r, s1, s2);
      s1 = s2;
    }
    const double miss = range_m - ray.p() * reach;
    const double slope = dx_dp * ray.sine * ray.sine * ray.sine / fastest;
    const double next = std::max(q + miss / slope, 0.0);
    const bool close = std::abs(next - q) <= 1e-9 * q;  // the square of the step is below rounding
    q = next;
    if (close) break;
    // Slow convergence near the end of the branch, where the ray becomes horizontal.
    if (step > 6 && !range_checked) {
      range_checked = true;
      const SnellRay grazing{fastest, 0, 1};
      double longest = 0;
      for (std::size_t i = 0; i < path.size(); ++i) {
        const double sines = grazing.sine_at(path[i].c1) + grazing.sine_at(path[i].c2);
        // Infinite in an isovelocity layer.
        longest += path[i].dz_m * (path[i].c1 + path[i].c2) / sines / fastest;
      }
      if (!(range_m < longest)) return std::nullopt;
    }
  }
  const SnellRay ray = at(q);
  return eigenray(ray, along(ray, path, true), depth_m, depth_m < source_m_, 0);
}

std::optional<Eigenray> EigenrayFinder::direct(double depth_m, double range_m) const {
  const double top = std::min(depth_m, source_m_), bottom = std::max(depth_m, source_m_);
  const std::size_t layer = common_layer(top, bottom);
  return layer != kNoLayer ? within_layer(layer, depth_m, range_m) : through_layers(depth_m, range_m);
}

// Adds the path to a turning point and back, `times` times.
void EigenrayFinder::add_turn(const SnellRay& ray, const std::vector<Piece>& path, double times,
                              bool times_too, RaySums& sums) const {
  const double p = ray.p();
  double s1 = path.empty() ? 0 : ray.sine_at(path.front().c1);
  for (const Piece& piece : path) {
    const double sine2 = ray.sine2_at(piece.c2);
    if (sine2 <= 0 && piece.gradient_per_s > 0) {
      if (times_too) {
        const RaySums turn = turning_arc(s1, s1, p, piece.gradient_per_s);
        sums = sums + times * turn;
        sums.absorption_db += times * water_.absorption_in(piece.layer) * turn.length_m;
      } else {
        const double reach = 2 * s1 / (p * p * piece.gradient_per_s);
        sums.reach += times * reach;
        sums.dx_dp -= times * arc_dx_dp(reach, s1, s1);
      }
      return;
    }
    const double s2 = std::sqrt(std::max(0.0, sine2));
    const double reach = arc_reach(piece.dz_m, piece.c1, piece.c2, s1, s2);
    sums.reach += 2 * times * reach;
    sums.dx_dp += 2 * times * arc_dx_dp(reach, s1, s2);
    if (times_too) {
      const double length = arc_length_m(piece.dz_m, reach, p, piece.gradient_per_s);
      sums.time_s += 2 * times * arc_time_s(piece.dz_m, piece.c1, piece.c2, s1, s2, p);
      sums.length_m += 2 * times * length;
      sums.absorption_db += 2 * times * water_.absorption_in(piece.layer) * length;
    }
    s1 = s2;
  }
}

// Bounds the range of rays that turn at a sound speed between a and b. They cross the layers before more
// steeply than the ray that turns at a, and less steeply than the ray that turns at b. The turning arc is
// longest for b.
std::pair<double, double> EigenrayFinder::range_bounds(const Section& section, const Order& order, double a,
                                                       double b) {
  const SnellRay flat{a, 0, 1}, steep{b, 0, 1};
  double longest = 0, shortest = 0;
  const auto add = [&](const std::vector<Piece>& path, int times, bool turning) {
    if (times == 0 || path.empty()) return;
    double flat1 = flat.sine_at(path.front().c1), steep1 = steep.sine_at(path.front().c1);
    for (const Piece& piece : path) {
      if (turning && piece.c2 >= b) {
        longest += times * turning_arc(steep1, steep1, steep.p(), piece.gradient_per_s).reach * steep.p();
        return;
      }
      const double flat2 = flat.sine_at(piece.c2), steep2 = steep.sine_at(piece.c2);
      const int passes = turning ? 2 * times : times;
      longest += passes * flat.p() * arc_reach(piece.dz_m, piece.c1, piece.c2, flat1, flat2);
      shortest += passes * steep.p() * arc_reach(piece.dz_m, piece.c1, piece.c2, steep1, steep2);
      flat1 = flat2;
      steep1 = steep2;
    }
  };
  add(section.between, order.between, false);
  add(section.above, order.above, true);
  add(section.below, order.below, true);
  return {shortest, longest};
}

// Near a caustic, a ray at launch angle u from a given ray is offset from it by w' u^2 / 2. It arrives at an
// angle that differs by f u, where f follows from Snell's law at a fixed point. The field is 2 sqrt(pi) Ai,
// as a function of the offset over (w' / (2 k^2 f^2))^(1/3). The largest square of this field corresponds to
// 3.6057, where two rays add up to 2 / sqrt(offset). Sources: Jensen, Kuperman, Porter & Schmidt,
// Computational Ocean Acoustics (2011), section 3; DLMF 9.9.
double EigenrayFinder::caustic_width_m_per_rad(double change_m_per_rad2, const Eigenray& ray,
                                               double depth_m) const {
  const double c = water_.profile.at(depth_m), wavenumber = 2 * std::numbers::pi * options_.frequency_hz / c;
  const auto sine = [](double s) { return std::max(std::abs(s), 1e-6); };
  const double turning = c * sine(ray.launch_sine) / (source_speed_ * sine(ray.arrival_sine));
  constexpr double at_airys_largest = 2 / 3.6057;
  const double width = 2 * at_airys_largest * std::cbrt(change_m_per_rad2 * change_m_per_rad2 / 4) /
                       std::cbrt(wavenumber * turning);
  return std::isfinite(width) ? width : 0;
}

// Finds rays that turn at a sound speed between a and b. The variable is the sine of their grazing angle at
// the depth where the sound speed is a.
void EigenrayFinder::search(const Section& section, const Order& order, double a, double b, double depth_m,
                            double range_m, std::vector<Eigenray>& found) const {
  const auto ray_at = [a](double sine) { return SnellRay{a, sine, std::sqrt((1 - sine) * (1 + sine))}; };
  const auto sums_at = [&](double sine, bool times_too) {
    const SnellRay ray = ray_at(sine);
    RaySums sums = double(order.between) * along(ray, section.between, times_too);
    if (order.above > 0) add_turn(ray, section.above, order.above, times_too, sums);
    if (order.below > 0) add_turn(ray, section.below, order.below, times_too, sums);
    return sums;
  };
  const auto miss = [&](double sine) { return ray_at(sine).p() * sums_at(sine, false).reach - range_m; };
  const auto slope_of = [a](const RaySums& sums, double sine) {  // derivative of the range by the sine
    return -sums.dx_dp * sine / (a * std::sqrt((1 - sine) * (1 + sine)));
  };
  const auto slope = [&](double sine) { return slope_of(sums_at(sine, false), sine); };
  const double top = std::sqrt((b - a) * (b + a)) / b, first = top * 1e-9, last = top * (1 - 1e-15);
  // Offset of neighbouring rays on arrival, per launch angle. The area per steradian is this offset times
  // the reach divided by the sound speed at the source.
  const auto beside = [&](double sine, const RaySums& sums) {
    const SnellRay ray = ray_at(sine);
    return ray.sine_at(source_speed_) * ray.sine_at(water_.profile.at(depth_m)) * sums.dx_dp / source_speed_;
  };
  const auto add = [&](double sine) {
    Eigenray e = eigenray(ray_at(sine), sums_at(sine, true), depth_m, order.launched_up, order.turns);
    const double step = 1e-4 * top, lo = std::max(first, sine - step), hi = std::min(last, sine + step);
    const RaySums low = sums_at(lo, false), high = sums_at(hi, false);
    const double turned =
        std::asin(ray_at(hi).sine_at(source_speed_)) - std::asin(ray_at(lo).sine_at(source_speed_));
    e.caustic_area_m2_per_sr =
        (low.reach + high.reach) / (2 * source_speed_) *
        caustic_width_m_per_rad((beside(hi, high) - beside(lo, low)) / turned, e, depth_m);
    found.push_back(e);
  };
  const auto add_between = [&](double lo, double hi, double miss_lo, double miss_hi) {
    if (miss_lo * miss_hi < 0 || miss_hi == 0) add(root_between(miss, lo, hi, miss_lo, miss_hi));
  };

  const auto [shortest, longest] = range_bounds(section, order, a, b);
  if (shortest > range_m || longest < range_m) return;
  constexpr int kSteps = 16;
  const auto both = [&](double sine) {
    const RaySums sums = sums_at(sine, false);
    return std::pair(ray_at(sine).p() * sums.reach - range_m, slope_of(sums, sine));
  };
  double lo = first;
  auto [miss_lo, slope_lo] = both(lo);
  for (int i = 1; i <= kSteps; ++i) {
    const double hi = i < kSteps ? top * i / kSteps : last;
    const auto [miss_hi, slope_hi] = both(hi);
    if (slope_lo * slope_hi < 0) {
      const double peak = root_between(slope, lo, hi, slope_lo, slope_hi), miss_peak = miss(peak);
      add_between(lo, peak, miss_lo, miss_peak);
      if (miss_peak != 0) add_between(peak, hi, miss_peak, miss_hi);
    } else {
      add_between(lo, hi, miss_lo, miss_hi);
    }
    lo = hi;
    miss_lo = miss_hi;
    slope_lo = slope_hi;
  }
}

std::vector<Eigenray> EigenrayFinder::all(double depth_m, double range_m) const {
  const double top_m = std::min(depth_m, source_m_), bottom_m = std::max(depth_m, source_m_);
  std::vector<Eigenray> found;
  if (auto ray = direct(depth_m, range_m)) found.push_back(*ray);
  if (!may_turn_towards(depth_m, range_m)) return found;

  const SoundSpeedProfile& profile = water_.profile;
  Section section;
  section.common_layer = common_layer(top_m, bottom_m);
  section.between = pieces(top_m, bottom_m);
  // The outermost layers are isovelocity, so no ray turns in them.
  const double shallowest = std::max(options_.surface_m, profile.points().front().depth_m);
  const double deepest = std::min(options_.deepest_turn_m, profile.points().back().depth_m);
  section.above = pieces_up(top_m, shallowest);
  section.below = pieces(bottom_m, deepest);
  double fastest = std::max(source_speed_, profile.at(depth_m));
  for (const Piece& piece : section.between) fastest = std::max({fastest, piece.c1, piece.c2});

  // Sound speeds at which the turning point passes into another layer.
  const auto speeds = [fastest](const std::vector<Piece>& path) {
    std::vector<double> result = {fastest};
    for (const Piece& piece : path) {
      if (piece.c2 > result.back()) result.push_back(piece.c2);
    }
    return result;
  };
  const std::vector<double> above = speeds(section.above), below = speeds(section.below);

  const bool source_is_upper = source_m_ <= depth_m;
  for (const bool launched_up : {false, true}) {
    Order order;
    order.launched_up = launched_up;
    bool up = launched_up, at_top = source_is_upper;
    while (order.turns <= options_.most_turns) {
      if (up != at_top) {  // towards the depth of the other end
        ++order.between;
        at_top = up;
      } else {
        ++(up ? order.above : order.below);
        ++order.turns;
        up = !up;
      }
      const bool arrived = at_top != source_is_upper;
      if (!arrived || order.turns == 0 || order.turns > options_.most_turns) continue;
      std::vector<double> borders;
      double least = std::numeric_limits<double>::infinity();
      if (order.above > 0) {
        borders.insert(borders.end(), above.begin(), above.end());
        least = std::min(least, above.back());
      }
      if (order.below > 0) {
        borders.insert(borders.end(), below.begin(), below.end());
        least = std::min(least, below.back());
      }
      std::sort(borders.begin(), borders.end());
      for (std::size_t i = 1; i < borders.size() && borders[i] <= least; ++i) {
        if (!(borders[i - 1] < borders[i])) continue;
        // The closed form covers a single turning point within the common layer.
        const std::vector<Piece>& path = order.above > 0 ? section.above : section.below;
        const bool closed_form =
            order.turns == 1 && path.front().layer == section.common_layer && borders[i] <= path.front().c2;
        if (!closed_form) search(section, order, borders[i - 1], borders[i], depth_m, range_m, found);
      }
    }
  }
  std::sort(found.begin(), found.end(),
            [](const Eigenray& a, const Eigenray& b) { return a.time_s < b.time_s; });
  return found;
}

}  // namespace tubefoot
