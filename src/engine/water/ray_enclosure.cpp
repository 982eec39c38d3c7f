// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/water/ray_enclosure.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/water/ray_differences.hpp"
#include "geometry/numbers/enclosure_slack.hpp"

// Encloses the ray from an apex to a patch of a plane, with first and second derivatives, in intervals that
// are rounded outwards. Within one layer the forms are closed. Through several layers the Snell parameter k
// follows from the implicit function k R(k, z)^2 = x^2 + y^2, with a verified bracket. See
// docs/notes/certified-energies.md, section "Through refracting water".
namespace tubefoot {
namespace {

/// Water of one gradient between two depths, in the direction of travel.
struct Leg {
  double dz_m;
  Interval c1, c2, gradient;
  std::size_t layer;
};

std::vector<Leg> legs_between(const SoundSpeedProfile& profile, double from_m, double to_m) {
  const bool down = from_m <= to_m;
  double top = std::min(from_m, to_m);
  const double bottom = std::max(from_m, to_m);
  std::vector<Leg> legs;
  for (std::size_t layer = profile.layer_at(top); top < bottom; ++layer) {
    const double end = std::min(profile.bottom_m(layer), bottom);
    const auto speed = [&](double z) {
      const double c = profile.speed_in(layer, z);
      return outwards(c, c, 4);
    };
    const double g = profile.gradient_per_s(layer);
    legs.push_back({end - top, speed(top), speed(end), outwards(g, g, 4), layer});
    top = end;
  }
  if (!down) {
    std::reverse(legs.begin(), legs.end());
    for (Leg& leg : legs) {
      std::swap(leg.c1, leg.c2);
      leg.gradient = -leg.gradient;
    }
  }
  return legs;
}

/// Sine of the grazing angle, sqrt(1 - k c^2). Not finite if a ray may not reach the sound speed.
Interval sine_at(const Interval& k, const Interval& c) {
  const Interval s2 = 1.0 - k * squared(c);
  return s2.surely_positive() ? root(s2) : outwards(1, 0);
}

Interval log1p_over(const Interval& v) {  // log(1 + v) / v, which decreases with v
  return v.lo > -1 ? outwards(log1p_ratio(v.hi), log1p_ratio(v.lo), 64) : outwards(1, 0);
}

/// asinh(sqrt v) / sqrt v = integral over u from 0 to 1 of 1 / sqrt(1 + v u^2), which decreases with v.
double asinh_ratio(double v) {
  if (v < 1e-4) return 1 - v * (1. / 6 - v * (3. / 40 - v * (5. / 112 - v * (35. / 1152))));
  return std::asinh(std::sqrt(v)) / std::sqrt(v);
}
Jet asinh_ratio(const Jet& v) {
  const double most = std::max(v.v.hi, 0.0), least = std::max(v.v.lo, 0.0), over = std::pow(1 + most, -1.5);
  return compose(v, outwards(asinh_ratio(most), asinh_ratio(least), 64),
                 outwards(-1. / 6, -over / 6, library_units),
                 outwards(0.15 * over / (1 + most), 0.15, library_units));
}

/// asin(sqrt w) / sqrt w = integral over u from 0 to 1 of 1 / sqrt(1 - w u^2), which grows with w < 1.
Interval asin_root_ratio(const Interval& w) {
  const double most = std::max(w.hi, 0.0), least = std::max(w.lo, 0.0);
  if (!(most < 1)) return outwards(1, 0);
  return outwards(asin_ratio(std::sqrt(least)), asin_ratio(std::sqrt(most)), 64);
}
Jet asin_root_ratio(const Jet& w) {
  const double most = std::max(w.v.hi, 0.0);
  const double over = most < 1 ? std::pow(1 - most, -1.5) : std::numeric_limits<double>::infinity();
  return compose(w, asin_root_ratio(w.v), outwards(1. / 6, over / 6, library_units),
                 outwards(0.15, 0.15 * over / (1 - most), library_units));
}

/// Intersection of two enclosures of the same quantity.
Interval common(const Interval& a, const Interval& b) {
  return b.is_finite() && b.lo <= a.hi && b.hi >= a.lo ? Interval(std::max(a.lo, b.lo), std::min(a.hi, b.hi))
                                                       : a;
}

Interval power(const Interval& x, int n) {
  Interval result = 1.0;
  for (int i = 0; i < n; ++i) result = result * x;
  return result;
}

/// Integral of c^p / s^q over a depth interval in which c is linear. The result is the intersection of two
/// enclosures. The first uses the range of the integrand. The second is the midpoint rule with a second
/// derivative by c, which is much narrower where s hardly changes.
Interval integral(int p, int q, const Interval& dz, const Interval& k, const Interval& c1,
                  const Interval& c2) {
  const Interval c = hull(c1, c2), s = sine_at(k, c), middle = 0.5 * (c1 + c2);
  const Interval plain = power(c, p) / power(s, q) * dz;
  const Interval t = k * squared(c) / squared(s);
  const Interval second =
      power(c, p - 2) / power(s, q) *
      (double(p * (p - 1)) + double(q * (2 * p + 1)) * t + double(q * (q + 2)) * squared(t));
  const Interval fine =
      (power(middle, p) / power(sine_at(k, middle), q) + squared(c2 - c1) * second / Interval(24.0)) * dz;
  if (!plain.is_finite() || !fine.is_finite()) return plain;
  return {std::max(plain.lo, fine.lo), std::min(plain.hi, fine.hi)};
}

}  // namespace

/// Integrals over depth from the source, and the required derivatives by k.
struct RayEnclosure::Sums {
  Interval reach, reach_k, reach_kk;  // of c / s
  Interval dx_dp, dx_dp_k;            // of c / s^3
  Interval time;                      // of 1 / (c s); its derivatives follow from those above
  Interval absorption, absorption_k;
  // Values near the end point of the rays.
  Interval c, gradient, absorption_per_m;
  bool some = false;

  /// Adds the derivatives that have no closed form here.
  void take_derivatives(const Interval& dz, const Interval& k, const Interval& c1, const Interval& c2,
                        const Interval& absorption_db_per_m) {
    reach_kk += 0.75 * integral(5, 5, dz, k, c1, c2);
    dx_dp_k += 1.5 * integral(3, 5, dz, k, c1, c2);
    absorption_k += 0.5 * integral(2, 3, dz, k, c1, c2) * absorption_db_per_m;
  }
  /// Adds all integrals over water whose sound speed lies anywhere in `over_c`, from the range of the
  /// integrands.
  void take(const Interval& dz, const Interval& k, const Interval& over_c,
            const Interval& absorption_db_per_m) {
    const Interval s = sine_at(k, over_c), s3 = power(s, 3), s5 = power(s, 5);
    reach_kk += 0.75 * (power(over_c, 5) / s5) * dz;
    dx_dp_k += 1.5 * (power(over_c, 3) / s5) * dz;
    absorption_k += 0.5 * (squared(over_c) / s3) * dz * absorption_db_per_m;
    reach += over_c / s * dz;
    reach_k += 0.5 * (power(over_c, 3) / s3) * dz;
    dx_dp += over_c / s3 * dz;
    time += 1.0 / (over_c * s) * dz;
    absorption += 1.0 / s * dz * absorption_db_per_m;
  }
};

RayEnclosure::RayEnclosure(const ApparentMap& apparent_map, const EigenrayOptions& options)
    : apparent_map_(apparent_map),
      options_(options),
      finder_(apparent_map.water(), apparent_map.finder().source_depth_m(), options),
      source_m_(finder_.source_depth_m()),
      source_speed_(finder_.source_speed_m_s()),
      reference_speed_(apparent_map.reference_speed_m_s()) {
  const auto& points = apparent_map.water().profile.points();
  const auto [slowest, fastest] = std::ranges::minmax(points, {}, &ProfilePoint::sound_speed_m_s);
  least_stretch_ = reference_speed_ / fastest.sound_speed_m_s * (1 - enclosure_slack);
  const double least_ratio = slowest.sound_speed_m_s / fastest.sound_speed_m_s;
  least_area_ratio_ = least_ratio * least_ratio * (1 - enclosure_slack);
  most_turn_rad_ = 2 * std::acos(slowest.sound_speed_m_s / fastest.sound_speed_m_s) * (1 + enclosure_slack) +
                   enclosure_slack;
}

/// Rays that turn at a sound speed from `a` to `b` pass water slower than `a` more steeply than the ray that
/// turns at `b`. Beyond both ends they pass this water twice.
bool RayEnclosure::turning_rays_are_longer(const Interval& depth_m, double farthest_m, bool below,
                                           std::optional<double> beyond_m) const {
  const SoundSpeedProfile& profile = apparent_map_.water().profile;
  const double end = below ? std::min(options_.deepest_turn_m, profile.points().back().depth_m)
                           : std::max(options_.surface_m, profile.points().front().depth_m);
  const double near = std::clamp(source_m_, depth_m.lo, depth_m.hi);
  // Every ray that turns beyond this depth has passed both ends.
  const double from = below ? std::max(source_m_, depth_m.hi) : std::min(source_m_, depth_m.lo);
  double earliest = below ? std::max(source_m_, depth_m.lo) : std::min(source_m_, depth_m.hi);
  if (beyond_m) earliest = below ? std::max(earliest, *beyond_m) : std::min(earliest, *beyond_m);
  const auto beyond_end = [&](double z) { return below ? z >= end : z <= end; };
  if (beyond_end(earliest)) return true;
  double slowest = source_speed_, fastest = 0;
  const std::vector<Leg> between = legs_between(profile, source_m_, near);
  for (const std::vector<Leg>& legs : {between, legs_between(profile, source_m_, earliest)})
    for (const Leg& leg : legs) slowest = std::max({slowest, leg.c1.lo, leg.c2.lo});
  for (const Leg& leg : legs_between(profile, earliest, end))
    fastest = std::max({fastest, leg.c1.hi, leg.c2.hi});
  if (!(fastest > slowest)) return true;
  const double turned = below ? std::max(from, earliest) : std::min(from, earliest);
  const std::vector<Leg> before = legs_between(profile, from, turned),
                         beyond =
                             beyond_end(turned) ? std::vector<Leg>() : legs_between(profile, turned, end);
  constexpr int parts = 64;
  for (int i = 0; i < parts; ++i) {
    const auto speed = [&](int k) { return slowest + (fastest - slowest) * k * k / double(parts * parts); };
    const double a = speed(i), b = speed(i + 1) * (1 + enclosure_slack);
    const Interval k = 1.0 / squared(Interval(b));
    const auto range = [&](const Leg& leg) {
      return (root(k) * leg.dz_m * (leg.c1 + leg.c2) / (sine_at(k, leg.c1) + sine_at(k, leg.c2))).lo;
    };
    double shortest = 0;
    for (const Leg& leg : between) shortest += range(leg);
    for (const Leg& leg : before) shortest += 2 * range(leg);
    for (const Leg& leg : beyond) {
      if (leg.c2.hi > a || leg.c1.hi > a) break;
      shortest += 2 * range(leg);
    }
    if (!(shortest > farthest_m)) return false;
  }
  return true;
}

bool RayEnclosure::no_ray_turns(const Interval& depth_m, double farthest_m) const {
  if (options_.most_turns < 1) return true;
  const double height =
      std::max({0.0, depth_m.lo - source_m_, source_m_ - depth_m.hi}) * (1 - enclosure_slack);
  if (finder_.steeper_than_turning(height, farthest_m * (1 + enclosure_slack))) return true;
  return options_.most_turns == 1 && turning_rays_are_longer(depth_m, farthest_m, true) &&
         turning_rays_are_longer(depth_m, farthest_m, false);
}

bool RayEnclosure::no_ray_comes_back(std::size_t layer, const Interval& depth_m, double farthest_m) const {
  const SoundSpeedProfile& profile = apparent_map_.water().profile;
  return options_.most_turns <= 1 &&
         turning_rays_are_longer(depth_m, farthest_m, true, profile.bottom_m(layer)) &&
         turning_rays_are_longer(depth_m, farthest_m, false, profile.top_m(layer));
}

/// Returns whether no other layer turns rays.
bool RayEnclosure::only_arc(std::size_t layer) const {
  const SoundSpeedProfile& profile = apparent_map_.water().profile;
  if (options_.most_turns > 1) return false;
  for (std::size_t other = 0; other < profile.layers(); ++other)
    if (other != layer && profile.gradient_per_s(other) != 0 &&
        profile.top_m(other) < options_.deepest_turn_m && profile.bottom_m(other) > options_.surface_m)
      return false;
  return true;
}

std::optional<RayJets> RayEnclosure::within_layer(std::size_t layer, const Jet& x, const Jet& y,
                                                  const Jet& depth, bool alone) const {
  const SoundSpeedProfile& profile = apparent_map_.water().profile;
  const double gradient = profile.gradient_per_s(layer);
  const Interval g = gradient == 0 ? Interval(0.0) : outwards(gradient, gradient, 4);
  const Interval cs = outwards(source_speed_, source_speed_, 4);
  const Jet dz = depth - Jet(source_m_), m = squared(x) + squared(y), d2 = m + squared(dz);
  const Jet cr = Jet(cs) + Jet(g) * dz, sum = Jet(cs) + cr;
  const Jet half = root(squared(sum) + Jet(squared(g)) * m);
  const Jet along = dz * sum, refracted = Jet(g) * m;
  const Interval launch = (along + refracted).v, arrival = (along - refracted).v;
  if (!d2.v.surely_positive() || !cr.v.surely_positive()) return std::nullopt;
  const bool straight_on = gradient == 0 || (launch * arrival).surely_positive();
  const double farthest = root(m.v).hi;
  if (!(only_arc(layer) || (straight_on && (alone || no_ray_turns(depth.v, farthest))) ||
        no_ray_comes_back(layer, depth.v, farthest)))
    return std::nullopt;
  if (!straight_on) {
    // Depth of the turning point of the rays that have one. By Snell's law, the sound speed there is that at
    // the source divided by the cosine of the launch angle. For such rays the launch and arrival sines have
    // opposite signs. So `along` is at most as large as `refracted`, whatever other rays the patch contains.
    const double flattest = std::min(2 * refracted.v.largest(), launch.largest()) * (1 + enclosure_slack);
    const Interval cosine = 2.0 * cs * root(m.v) / (root(d2.v) * half.v);
    const Interval sine2 = squared(Interval(-flattest, flattest)) / (d2.v * squared(half.v));
    Interval turn = source_m_ + cs * sine2 / (cosine * (1.0 + cosine) * g);
    (gradient > 0 ? turn.lo : turn.hi) = source_m_;  // the turning point lies on the side of faster sound
    if (!(turn.lo >= std::max(profile.top_m(layer), options_.surface_m) &&
          turn.hi <= std::min(profile.bottom_m(layer), options_.deepest_turn_m)))
      return std::nullopt;
  }
  const Jet v = Jet(0.25 * squared(g)) * d2 / (Jet(cs) * cr), s = asinh_ratio(v), speeds = root(Jet(cs) * cr);
  const Jet d = root(d2), size = Jet(reference_speed_) * s / (speeds * half);
  RayJets rays;
  const Jet across = size * Jet(2.0 * cs);
  rays.image = {across * x, across * y, -(size * (along + refracted))};
  rays.time_s = d * s / speeds;
  rays.slowness_s_per_m = s / speeds;
  rays.arrival_across = Jet(2.0) * cr / half;
  rays.arrival_down_m = (along - refracted) / half;
  rays.area_ratio_per_sr = Jet(cs) * (Jet(1.0) + v) / cr;
  rays.absorption_db = Jet(apparent_map_.water().absorption_in(layer)) * d *
                       asin_root_ratio(Jet(squared(g)) * m / squared(half));
  return rays;
}

RayEnclosure::Sums RayEnclosure::sums_to(double depth_m, const Interval& k) const {
  const WaterColumn& water = apparent_map_.water();
  Sums sums;
  for (const Leg& leg : legs_between(water.profile, source_m_, depth_m)) {
    const Interval s1 = sine_at(k, leg.c1), s2 = sine_at(k, leg.c2), dz(leg.dz_m), both = leg.c1 + leg.c2;
    const Interval reach = dz * both / (s1 + s2), product = s1 * s2;
    sums.reach += reach;
    sums.dx_dp += reach / product;
    sums.reach_k += 0.5 * reach * (squared(leg.c1) + squared(leg.c2) - k * squared(leg.c1 * leg.c2)) /
                    (product * (1.0 + product));
    const Interval change = leg.gradient * dz, w = k * both / ((s1 + s2) * (1.0 + s2));
    sums.time += dz * (log1p_over(change / leg.c1) / leg.c1 + w * log1p_over(change * w));
    const Interval chord2 = squared(dz) + k * squared(reach);
    const Interval absorption(water.absorption_in(leg.layer));
    sums.absorption += absorption * root(chord2) * asin_root_ratio(0.25 * chord2 * k * squared(leg.gradient));
    sums.take_derivatives(dz, k, leg.c1, leg.c2, absorption);
  }
  return sums;
}

/// Adds the water between the nearer and the farther end of a patch, with any thickness from zero to the
/// whole.
bool RayEnclosure::extend(Sums& sums, const Interval& k, double from_m, double to_m) const {
  const WaterColumn& water = apparent_map_.water();
  const bool down = to_m >= source_m_ && from_m >= source_m_;
  // A border between layers belongs to both layers.
  const double more = 1e-9 * (1 + std::abs(to_m));
  const double near = from_m == source_m_ ? from_m : (down ? from_m - more : from_m + more);
  for (const Leg& leg : legs_between(water.profile, near, down ? to_m + more : to_m - more)) {
    const Interval c = hull(leg.c1, leg.c2), absorption(water.absorption_in(leg.layer));
    sums.c = sums.some ? hull(sums.c, c) : c;
    sums.gradient = sums.some ? hull(sums.gradient, leg.gradient) : leg.gradient;
    sums.absorption_per_m = sums.some ? hull(sums.absorption_per_m, absorption) : absorption;
    sums.some = true;
  }
  if (!sums.some) return false;
  sums.take(Interval(0, std::abs(to_m - from_m) * (1 + enclosure_slack)), k, sums.c, sums.absorption_per_m);
  return true;
}

std::optional<RayJets> RayEnclosure::through_layers(const Jet& x, const Jet& y, const Jet& depth,
                                                    bool alone) const {
  const bool down = depth.v.lo > source_m_;
  if (!down && !(depth.v.hi < source_m_)) return std::nullopt;
  const double near = down ? depth.v.lo : depth.v.hi, far = down ? depth.v.hi : depth.v.lo;
  const Jet m = squared(x) + squared(y);
  if (!alone && !no_ray_turns(depth.v, root(m.v).hi)) return std::nullopt;
  // Bracket of k. The parameter k grows with the range and decreases with the depth difference.
  const auto guess = [&](double depth_m, double range_m) -> std::optional<double> {
    const std::optional<Eigenray> ray = finder_.direct(depth_m, range_m);
    if (!ray) return std::nullopt;
    return ray->launch_cosine * ray->launch_cosine / (source_speed_ * source_speed_);
  };
  const auto range2 = [&](double depth_m, double k) {
    return Interval(k) * squared(sums_to(depth_m, Interval(k)).reach);
  };
  double least = 0, most = 0;
  if (m.v.lo > 0) {
    const auto k = guess(far, std::sqrt(m.v.lo));
    if (!k) return std::nullopt;
    bool proven = false;
    for (double off = 4e-15; off < 1e-6 && !proven; off *= 16)
      proven = range2(far, least = *k * (1 - off)).hi <= m.v.lo;
    if (!proven) least = 0;
  }
  const auto k_most = guess(near, std::sqrt(m.v.hi) * (1 + 1e-15));
  if (!k_most) return std::nullopt;
  bool proven = false;
  for (double off = 4e-15; off < 1e-6 && !proven; off *= 16) {
    const Interval found = range2(near, most = *k_most * (1 + off) + 1e-40);
    proven = found.is_finite() && found.lo >= m.v.hi;
  }
  if (!proven) return std::nullopt;

  const Interval k(least, most);
  Sums sums = sums_to(near, k);
  if (!extend(sums, k, near, far)) return std::nullopt;
  const Interval &c = sums.c, &g = sums.gradient, s = sine_at(k, c), s3 = power(s, 3), cube = power(c, 3);
  const Interval reach_z = c / s, reach_kz = 0.5 * cube / s3, reach_zz = g / s3, dx_dp_z = c / s3;
  const Interval G_k = sums.reach * sums.dx_dp, G_z = 2.0 * k * sums.reach * reach_z,
                 G_kk = sums.reach_k * sums.dx_dp + sums.reach * sums.dx_dp_k,
                 G_kz = reach_z * sums.dx_dp + sums.reach * dx_dp_z,
                 G_zz = 2.0 * k * (squared(reach_z) + sums.reach * reach_zz);
  if (!G_k.is_finite() || !G_k.surely_positive()) return std::nullopt;
  Partials by;
  by.f = k;
  by.x = 1.0 / G_k;
  by.y = -G_z / G_k;
  by.xx = -(G_kk * squared(by.x)) / G_k;
  by.xy = -(G_kk * by.x * by.y + G_kz * by.x) / G_k;
  by.yy = -(G_kk * squared(by.y) + 2.0 * (G_kz * by.y) + G_zz) / G_k;
  const Jet path = down ? depth - Jet(source_m_) : Jet(source_m_) - depth;
  const Jet kj = compose(m, path, by);
  const Jet time = compose(kj, path,
                           {sums.time, 0.5 * sums.dx_dp, 1.0 / (c * s), 0.5 * sums.dx_dp_k, 0.5 * dx_dp_z,
                            g * (k / s3 - 1.0 / (squared(c) * s))});
  const Jet reach = compose(kj, path, {sums.reach, sums.reach_k, reach_z, sums.reach_kk, reach_kz, reach_zz});
  const Jet dx_dp = compose(kj, path, {sums.dx_dp, sums.dx_dp_k, dx_dp_z, 0.0, 0.0, 0.0});
  const Jet speed = compose(path, c, g, 0.0);
  const Interval cs = outwards(source_speed_, source_speed_, 4);
  const Jet launch = root(Jet(1.0) - kj * Jet(squared(cs))), arrival = root(Jet(1.0) - kj * squared(speed));
  if (!launch.v.surely_positive()) return std::nullopt;
  RayJets rays;
  const Jet d2 = m + squared(path), d = root(d2);
  std::vector<RayDifferences::Part> parts;
  for (const Leg& leg : legs_between(apparent_map_.water().profile, source_m_, near))
    parts.push_back({leg.dz_m, hull(leg.c1, leg.c2)});
  parts.push_back({Interval(0, std::abs(far - near) * (1 + enclosure_slack)), c});
  const RayDifferences differences(parts, {k, sums.reach, sums.reach_k, sums.time, sums.dx_dp, sums.dx_dp_k,
                                           c, s, g, cs, launch.v, path.v, d2.v});
  const Jet ref(reference_speed_), across = ref * compose(kj, path, differences.across()),
                                   below = ref * compose(kj, path, differences.below());
  rays.image = {across * x, across * y, down ? -below : below};
  rays.time_s = time;
  // Values at one point, for the middle of the bracket of k and the nearer end. From this point on, slopes
  // give narrower enclosures than the ranges of values.
  const Interval k0(k.middle()), h0 = root(squared(Interval(near) - source_m_)), k_off = k - k0,
                                 h_off = path.v - h0;
  const Sums there = sums_to(near, k0);
  const double end_speed = apparent_map_.water().profile.at(near);
  const Interval c0 = outwards(end_speed, end_speed, 8), d0 = root(k0 * squared(there.reach) + squared(h0));
  rays.slowness_s_per_m = compose(kj, path, differences.slowness(there.time / d0, k_off, h_off));
  const auto with_slopes = [&](Jet value, const Interval& at_one_place, const RayDifferences::Slopes& slope) {
    value.a = slope.k * kj.a + slope.z * path.a;
    value.b = slope.k * kj.b + slope.z * path.b;
    value.v = common(value.v, at_one_place + slope.k * k_off + slope.z * h_off);
    return value;
  };
  const auto with_logs = [&](const Jet& value, const Interval& at_one_place,
                             const RayDifferences::Slopes& logs) {
    return with_slopes(value, at_one_place, {value.v * logs.k, value.v * logs.z});
  };
  rays.arrival_across = with_logs(d * speed / reach, d0 * c0 / there.reach, differences.log_arrival_across());
  const Interval s_there = sine_at(k0, c0);
  const Jet arrival_down = with_slopes(d * arrival, d0 * s_there, differences.arrival_down());
  rays.arrival_down_m = down ? arrival_down : -arrival_down;
  rays.area_ratio_per_sr =
      with_logs(reach * launch * arrival * dx_dp / (squared(speed) * d2),
                there.reach * root(1.0 - k0 * squared(cs)) * s_there * there.dx_dp / squared(c0 * d0),
                differences.log_area());
  rays.absorption_db =
      compose(kj, path, {sums.absorption, sums.absorption_k, sums.absorption_per_m / s, 0.0, 0.0, 0.0});
  return rays;
}

std::optional<RayJets> RayEnclosure::over(const std::array<Interval, 3>& origin_m, const glm::dvec3& u,
                                          const glm::dvec3& v, const Interval& a, const Interval& b,
                                          bool alone) const {
  std::array<Jet, 3> at;
  for (int i = 0; i < 3; ++i) {
    at[i].v = origin_m[i] + a * u[i] + b * v[i];
    at[i].a = outwards(u[i], u[i], 4);
    at[i].b = outwards(v[i], v[i], 4);
  }
  const Jet depth = Jet(source_m_) - at[2];
  const SoundSpeedProfile& profile = apparent_map_.water().profile;
  // Finds a layer that contains both ends. The patch may touch the borders of the layer.
  const std::size_t layer = profile.layer_at(std::min(source_m_, depth.v.middle()));
  for (const std::size_t common : {layer, layer + 1})
    if (common < profile.layers() && profile.top_m(common) <= std::min(source_m_, depth.v.lo) &&
        profile.bottom_m(common) >= std::max(source_m_, depth.v.hi))
      return within_layer(common, at[0], at[1], depth, alone);
  return through_layers(at[0], at[1], depth, alone);
}

bool RayEnclosure::none_turns_before(const std::array<Interval, 3>& origin_m, const glm::dvec3& u,
                                     const glm::dvec3& v, const Interval& a, const Interval& b) const {
  std::array<Interval, 3> at;
  for (int i = 0; i < 3; ++i) at[i] = origin_m[i] + a * u[i] + b * v[i];
  return no_ray_turns(source_m_ - at[2], root(squared(at[0]) + squared(at[1])).hi);
}

}  // namespace tubefoot
