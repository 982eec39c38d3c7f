// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "geometry/numbers/interval.hpp"

// Encloses derivatives of rays through several layers by the Snell parameter and by depth. The forms use
// differences of squared sound speeds, so that all terms of isovelocity water cancel before they are
// enclosed.
namespace tubefoot {

/// Encloses derivatives of a ray's apparent position, slowness, arrival angle and tube area through several
/// layers. The variables are the Snell parameter k and the depth h that the ray passes. The forms use
/// differences of squared sound speeds. Terms that are equal in isovelocity water cancel before they are
/// enclosed. In weakly refracting water the remainders are therefore small.
///
/// The sums over layers are R = sum c / s dz (range over the ray parameter p), T = sum dz / (c s) (time) and
/// D = sum c / s^3 dz (dx / dp). Here s = sqrt(1 - k c^2) is the sine of the grazing angle, and d^2 = k R^2
/// + h^2 is the squared straight distance. Symbols c and s without an index belong to the end of the ray.
/// Differences use identities such as c_i s_j - c_j s_i = (c_i^2 - c_j^2) / (c_i s_j + c_j s_i).
class RayDifferences {
 public:
  /// Depth interval that the ray passes, and an enclosure of the sound speed in it.
  struct Part {
    Interval dz_m, c;
  };
  struct Ray {
    Interval k, R, R_k, T, D, D_k;
    Interval c, s, gradient;  ///< at the end of the ray, in the direction of travel
    Interval cs, s0;          ///< at the beginning of the ray
    Interval h_m, distance2;  ///< depth that the ray passes, and d^2
  };

  RayDifferences(std::span<const Part> parts, const Ray& ray) : ray_(ray) {
    const auto& [k, R, R_k, T, D, D_k, c, s, g, cs, s0, h, d2] = ray;
    Interval over = hull(c, cs), sines = hull(s, s0);
    for (const Part& part : parts) over = hull(over, part.c);
    const auto sine = [&k = k](const Interval& speed) { return root(1.0 - k * squared(speed)); };
    for (const Part& part : parts) sines = hull(sines, sine(part.c));
    const double c_apart = over.width(), c2_apart = (squared(over).hi - squared(over).lo);
    c4_apart_ = Interval(0, c2_apart * c2_apart * (1 + 1e-12));
    // For every pair of parts, k (c - c')^2 + (s - s')^2 + (c - c')^2 / (c c') lies in this interval.
    const Interval apart2 = Interval(0, c_apart * c_apart * (1 + 1e-12));
    pairs_ = k * apart2 + squared(k) * c4_apart_ / squared(2.0 * sines) + apart2 / squared(over);
    pairs_ = Interval(0, pairs_.hi);
    for (const Part& part : parts) {
      const Interval &dz = part.dz_m, &ci = part.c, si = sine(ci), si3 = si * si * si, si5 = si3 * si * si;
      const Interval e = squared(ci) - squared(c), e0 = squared(ci) - squared(cs), turned = ci * s + c * si;
      S1_ += dz / si;
      B_ += dz / (ci * si3);
      B5_ += dz * ci / si5;
      e1_ += e * dz / (ci * si);
      e3_ += e * dz / (ci * si3);
      ce3_ += ci * e * dz / si3;
      ce5_ += ci * e * dz / si5;
      const Interval from_source = e0 * dz / (ci * s0 * si3);
      y_k_ += 0.5 * from_source;
      y_kk_ += 0.25 * from_source * (squared(cs) / squared(s0) + 3.0 * squared(ci) / squared(si));
      V_z_ += g * dz / (ci * si) * (e * (k / (s * s * s) - 1.0 / (squared(c) * s)) - 2.0 / s);
      F2_ += dz * e * (1.0 - k * (squared(ci) + squared(c))) / ((ci * si + c * s) * ci * si);
      Z_ += dz * e / (turned * si);
      r_ += dz * e / (turned * si * s);
      slower_ += dz / si * ((ci - c) / ci);
    }
    E_ = -0.5 * pairs_ * squared(S1_);
    W_ = -0.25 * c4_apart_ * squared(B_);
    P_ = k * R * c + s * h;
  }

  /// Partial derivatives of cs T / R, which is the horizontal displacement of the image per metre of the
  /// point.
  Partials across() const {
    const auto& [k, R, R_k, T, D, D_k, c, s, g, cs, s0, h, d2] = ray_;
    const Interval R2 = squared(R), R3 = R2 * R, R_z = c / s, V = e1_ / (c * s),
                   W_k = -0.75 * c4_apart_ * B_ * B5_, W_z = -0.5 * c4_apart_ * B_ / (c * s * s * s);
    Partials by;
    by.f = cs * T / R;
    by.x = cs * (W_ / R2);
    by.y = cs * (V / R2);
    by.xx = cs * (W_k / R2 - 2.0 * (W_ * R_k / R3));
    by.xy = cs * (W_z / R2 - 2.0 * (W_ * R_z / R3));
    by.yy = cs * (V_z_ / R2 - 2.0 * (V * R_z / R3));
    return by;
  }
  /// Partial derivatives of T s0, which gives the depth of the image.
  Partials below() const {
    const auto& [k, R, R_k, T, D, D_k, c, s, g, cs, s0, h, d2] = ray_;
    const Interval further = squared(c) - squared(cs);
    Partials by;
    by.f = T * s0;
    by.x = y_k_;
    by.y = root(1.0 + k * further / squared(s)) / c;
    by.xx = y_kk_;
    by.xy = 0.5 * further / (c * s0 * s * s * s);
    by.yy = s0 * g * (k / (s * s * s) - 1.0 / (squared(c) * s));
    return by;
  }
  /// Partial derivatives of T / d. The value is also enclosed from its value `there` at another k and depth.
  Partials slowness(const Interval& there, const Interval& k_from_there, const Interval& h_from_there) const {
    const auto& [k, R, R_k, T, D, D_k, c, s, g, cs, s0, h, d2] = ray_;
    const Interval F = k * R * e1_ + h * F2_, per = c * s * T * d2, log_k = D * E_ / (2.0 * T * d2),
                   log_z = F / per, d2_z = 2.0 * P_ / s, D_z = c / (s * s * s), T_z = 1.0 / (c * s),
                   E_z = -(S1_ * pairs_) / s, later = slower_ - 0.5 * S1_ * pairs_,
                   F_z = later / s - g * T * (P_ + c * k * r_);
    Interval n = T / root(d2);
    // The first pass determines the slopes. The second pass uses the slopes to narrow the value.
    const Interval near = there + n * log_k * k_from_there + n * log_z * h_from_there;
    if (near.is_finite() && near.lo <= n.hi && near.hi >= n.lo)
      n = {std::max(n.lo, near.lo), std::min(n.hi, near.hi)};
    Partials by;
    by.f = n;
    by.x = n * log_k;
    by.y = n * log_z;
    by.xx = n * (squared(log_k) + D * W_ / (2.0 * T * d2) + log_k * (D_k / D - D / (2.0 * T) - R * D / d2));
    by.xy = n * (log_k * log_z + D * E_z / (2.0 * T * d2) + E_ * D_z / (2.0 * T * d2) -
                 log_k * (T_z / T + d2_z / d2));
    by.yy = n * (squared(log_z) + F_z / per -
                 log_z * (g * (s - k * squared(c) / s) / (c * s) + 1.0 / (c * s * T) + d2_z / d2));
    return by;
  }

  /// First derivatives by k and by depth.
  struct Slopes {
    Interval k, z;
  };
  /// Slopes of the logarithm of d c / R.
  Slopes log_arrival_across() const {
    const auto& [k, R, R_k, T, D, D_k, c, s, g, cs, s0, h, d2] = ray_;
    return {(R * W_ - R_k * E_) / (d2 * R), g / c + h * Z_ / (s * d2 * R)};
  }
  /// Slopes of d s.
  Slopes arrival_down() const {
    const auto& [k, R, R_k, T, D, D_k, c, s, g, cs, s0, h, d2] = ray_;
    const Interval d = root(d2);
    return {(R * e3_ - squared(c) * E_) / (2.0 * d * s),
            root(1.0 - k * squared(Z_) / d2) - d * k * c * g / s};
  }
  /// Slopes of the logarithm of R s0 s D / (c d)^2.
  Slopes log_area() const {
    const auto& [k, R, R_k, T, D, D_k, c, s, g, cs, s0, h, d2] = ray_;
    const Interval s2 = squared(s), apart = h * Z_ / (s * d2 * R);
    return {-((R * W_ - R_k * E_) / (d2 * R)) + 1.5 * ce5_ / (D * s2) - 0.5 * e3_ / (T * s2) -
                0.5 * (squared(cs) - squared(c)) / (squared(s0) * s2) + D * E_ / (2.0 * T * d2),
            -apart - (P_ * k * ce3_ + h * Z_) / (s * s2 * D * d2) - k * c * g / s2 - 2.0 * g / c};
  }

 private:
  Ray ray_;
  Interval c4_apart_, pairs_;
  // With e = c_i^2 - c^2, these are sums of e / (c_i s_i), e / (c_i s_i^3), c_i e / s_i^3, c_i e / s_i^5 and
  // others.
  Interval S1_, B_, B5_, e1_, e3_, ce3_, ce5_, y_k_, y_kk_, V_z_, F2_, Z_, r_, slower_;
  Interval E_, W_, P_;  // d^2 - R T, its derivative by k, and k R c + s h
};

}  // namespace tubefoot
