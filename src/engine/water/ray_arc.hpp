// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>

// Closed forms of a ray within one layer c = c0 + g z, where the ray is an arc of a circle. The forms do not
// divide by the gradient and do not subtract nearly equal numbers. So a straight ray (g = 0) is no special
// case. Sines are those of the grazing angles at the two ends of the arc, without sign. The Snell parameter
// p = cos(grazing) / c is constant along a ray. Source: Jensen, Kuperman, Porter & Schmidt, Computational
// Ocean Acoustics (2011), section 3.
namespace tubefoot {

/// Sums of range, time, length and absorption along a leg of a ray.
struct RaySums {
  double reach = 0;  ///< horizontal range / p [m^2/s], finite for vertical rays too
  double dx_dp = 0;  ///< derivative of the horizontal range between two depths by p [m^2/s]
  double time_s = 0;
  double length_m = 0;
  double absorption_db = 0;  ///< one way
};

inline RaySums operator+(const RaySums& a, const RaySums& b) {
  return {a.reach + b.reach, a.dx_dp + b.dx_dp, a.time_s + b.time_s, a.length_m + b.length_m,
          a.absorption_db + b.absorption_db};
}
inline RaySums operator*(double k, const RaySums& a) {
  return {k * a.reach, k * a.dx_dp, k * a.time_s, k * a.length_m, k * a.absorption_db};
}

/// log(1 + v) / v.
inline double log1p_ratio(double v) {
  if (std::abs(v) > 0.01) return std::log1p(v) / v;
  return 1 - v * (1. / 2 - v * (1. / 3 - v * (1. / 4 - v * (1. / 5 - v * (1. / 6 - v * (1. / 7 - v / 8))))));
}

/// asin(v) / v.
inline double asin_ratio(double v) {
  const double v2 = v * v;
  if (v2 > 1e-3) return std::asin(v) / v;
  return 1 + v2 * (1. / 6 + v2 * (3. / 40 + v2 * (15. / 336 + v2 * 105. / 3456)));
}

/// A ray, given by its direction at one sound speed. Snell's law determines its direction elsewhere.
struct SnellRay {
  double sound_speed_m_s = 1500;
  double sine = 1, cosine = 0;  ///< of the grazing angle at that sound speed; sine >= 0

  double p() const { return cosine / sound_speed_m_s; }
  /// Square of the sine at sound speed `c`. It is negative if the ray does not reach this sound speed.
  double sine2_at(double c) const {
    const double k = cosine / sound_speed_m_s;
    return sine * sine + k * k * (sound_speed_m_s - c) * (sound_speed_m_s + c);
  }
  double sine_at(double c) const { return std::sqrt(std::max(0.0, sine2_at(c))); }
};

/// Range / p over a depth interval `dz_m` > 0 without a turning point, from the chord of the circle.
inline double arc_reach(double dz_m, double c1, double c2, double s1, double s2) {
  return dz_m * (c1 + c2) / (s1 + s2);
}

/// d(range)/dp = reach / (s1 s2). Through a turning point the sign is reversed.
inline double arc_dx_dp(double reach, double s1, double s2) { return reach / (s1 * s2); }

/// Travel time over a depth interval without a turning point: (1/g) ln[(c2/c1) (1+s1)/(1+s2)].
inline double arc_time_s(double dz_m, double c1, double c2, double s1, double s2, double p) {
  const double speeds = log1p_ratio((c2 - c1) / c1) / c1;
  const double slope = p * p * (c1 + c2) / ((s1 + s2) * (1 + s2));  // (s1 - s2) / (1 + s2) / (c2 - c1)
  return dz_m * (speeds + slope * log1p_ratio((c2 - c1) * slope));
}

/// Length of the arc over a chord. The radius of the circle is 1 / (p |g|).
inline double arc_length_m(double dz_m, double reach, double p, double gradient_per_s) {
  const double chord = std::hypot(dz_m, p * reach);
  return chord * asin_ratio(chord * p * gradient_per_s / 2);
}

/// Arc from sine s1 to the turning point and on to sine s2, for a gradient of magnitude |g| > 0.
inline RaySums turning_arc(double s1, double s2, double p, double gradient_per_s) {
  const double g = std::abs(gradient_per_s);
  RaySums sums;
  sums.reach = (s1 + s2) / (p * p * g);
  sums.dx_dp = -arc_dx_dp(sums.reach, s1, s2);
  sums.time_s = (std::atanh(s1) + std::atanh(s2)) / g;
  sums.length_m = (std::asin(s1) + std::asin(s2)) / (p * g);
  return sums;
}

}  // namespace tubefoot
