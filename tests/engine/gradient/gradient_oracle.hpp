// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <boost/math/constants/constants.hpp>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <functional>
#include <vector>

#include "engine/scattering/range_samples.hpp"
#include "engine/visibility/history.hpp"
#include "geometry/mesh/facet_mesh.hpp"

// Derivatives of energies in 50 digits, independent of the code under test. Corners follow from the
// definitions of their names, with points that move. Let dG/dr = r f(r). The energy of a range bin is the
// integral of G(r) - G(D) over the polar angle about the foot point. Ranges are clamped to the bin.
// Derivatives are central differences of order 4 with a step of 1e-9.
namespace tubefoot::test {

using Real =
    boost::multiprecision::number<boost::multiprecision::cpp_bin_float<50>, boost::multiprecision::et_off>;
using RealVector = std::array<Real, 3>;

inline Real dot_of(const RealVector& a, const RealVector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline RealVector cross_of(const RealVector& a, const RealVector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
/// a + factor b.
inline RealVector sum_of(const RealVector& a, const Real& factor, const RealVector& b) {
  return {a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]};
}

/// Nodes and weights of Gauss and Legendre on [-1, 1], by Newton's method.
struct RealRule {
  std::vector<Real> node, weight;
  explicit RealRule(int n) {
    for (int k = 1; k <= n; ++k) {
      Real x = std::cos(3.141592653589793 * (k - 0.25) / (n + 0.5)), slope = 0;
      for (int step = 0; step < 9; ++step) {
        Real before = 1, value = x;
        for (int m = 2; m <= n; ++m) {
          const Real next = ((2 * m - 1) * x * value - (m - 1) * before) / m;
          before = value;
          value = next;
        }
        slope = n * (x * value - before) / (x * x - 1);
        x -= value / slope;
      }
      node.push_back(x);
      weight.push_back(2 / ((1 - x * x) * slope * slope));
    }
  }
  template <class F>
  Real operator()(const Real& from, const Real& to, const F& f) const {
    Real sum = 0;
    for (std::size_t k = 0; k < node.size(); ++k)
      sum += weight[k] * f((from + to) / 2 + (to - from) / 2 * node[k]);
    return sum * (to - from) / 2;
  }
};
inline const RealRule& real_rule() {
  static const RealRule rule(40);
  return rule;
}

/// How a parameter changes a scene. `velocity`: of a vertex in metres and of a ray in its own unit.
struct RealMotion {
  std::function<RealVector(PointId, const RealVector& at)> velocity{};
  Real by_absorption = 0, by_range_scale = 0, by_mu = 0;
};

class GradientOracle {
 public:
  GradientOracle(const FacetMesh& mesh, const History& history, const RangeSamples& samples, double mu,
                 double absorption_db_per_m)
      : mesh_(mesh), history_(history), mu_(mu), absorption_(absorption_db_per_m) {
    for (int k = 0; k <= samples.count; ++k) borders_.push_back(sample_borders_m(samples)[std::size_t(k)]);
  }

  /// Returns the derivatives of the energies, [tube][sample].
  std::vector<Real> derivatives(const RealMotion& motion) {
    const Real step("1e-9");
    std::vector<Real> sum(history_.tubes.tubes.size() * (borders_.size() - 1));
    for (const auto& [place, weight] : {std::pair{-2, 1}, {-1, -8}, {1, 8}, {2, -1}}) {
      const std::vector<Real> energy = energies(motion, place * step);
      for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += weight * energy[k] / (12 * step);
    }
    return sum;
  }

 private:
  struct RealPlane {
    RealVector normal;
    Real offset;
  };

  RealVector point(PointId id) const {
    const FootprintSet& set = history_.footprints;
    const GridPoint p =
        id & ray_bit ? set.name_rays[id & ~ray_bit] : mesh_.vertices[id] - history_.tubes.apex;
    const Real unit = id & ray_bit ? 1 : history_.grid_unit_m;
    const RealVector at{unit * p.x, unit * p.y, unit * p.z};
    return motion_->velocity ? sum_of(at, moved_, motion_->velocity(id, at)) : at;
  }
  RealPlane plane(FacetId facet) const {
    const auto& [a, b, c] = mesh_.facets[facet];
    const RealVector first = point(a);
    const RealVector normal = cross_of(sum_of(point(b), -1, first), sum_of(point(c), -1, first));
    return {normal, dot_of(normal, first)};
  }
  /// On a depth plane, the planes of both facets have the same depth along each ray.
  RealVector normal(const PlaneName& name) const {
    if (!name.depth) return cross_of(point(name.a), point(name.b));
    const RealPlane one = plane(name.a), other = plane(name.b);
    RealVector scaled{};
    for (std::size_t k = 0; k < 3; ++k)
      scaled[k] = one.normal[k] / one.offset - other.normal[k] / other.offset;
    return scaled;
  }
  RealVector corner(const CornerName& name, const RealPlane& on) const {
    const RealVector ray =
        name.point != no_point ? point(name.point) : cross_of(normal(name.p), normal(name.q));
    return sum_of({0, 0, 0}, on.offset / dot_of(on.normal, ray), ray);
  }

  /// Returns the integral of s^-5 e^(-2 beta s) from infinity to r. It is -r^-4 E_5(2 beta r), with the
  /// series of the exponential integral (Abramowitz and Stegun 5.1.12).
  Real antiderivative(const Real& r) const {
    const Real r4 = r * r * r * r;
    if (beta_ == 0) return -1 / (4 * r4);
    const Real x = 2 * beta_ * r, euler = boost::math::constants::euler<Real>();
    Real power = 1, sum = 0;  // power: (-x)^m / m!
    for (int m = 0; m < 200 && (m <= 5 || abs(power) > Real("1e-55")); ++m) {
      if (m == 4)
        sum -= power * (log(x) + euler - Real(25) / 12);
      else
        sum -= power / (m - 4);
      power *= -x / (m + 1);
    }
    return -sum / r4;
  }

  std::vector<Real> energies(const RealMotion& motion, const Real& moved) {
    motion_ = &motion;
    moved_ = moved;
    beta_ = (absorption_ + moved * motion.by_absorption) * log(Real(10)) / 10;
    const Real mu = mu_ + moved * motion.by_mu;
    limits_.clear();
    for (const Real& border : borders_) limits_.push_back(border * (1 + moved * motion.by_range_scale));
    const std::size_t row = borders_.size() - 1;
    std::vector<Real> energy(history_.tubes.tubes.size() * row);
    const FootprintSet& set = history_.footprints;
    for (const Footprint& footprint : set.footprints)
      for (std::uint32_t p = 0; p < footprint.piece_count; ++p) {
        const Piece& piece = set.pieces[footprint.first_piece + p];
        RealPlane on = plane(footprint.facet);
        Real length = sqrt(dot_of(on.normal, on.normal));
        if (on.offset < 0) length = -length;  // the unit normal points away from the apex
        for (Real& x : on.normal) x /= length;
        on.offset /= length;
        const Real factor = mu * on.offset * on.offset;
        std::vector<RealVector> corners;
        for (std::uint32_t c = 0; c < piece.count; ++c)
          corners.push_back(sum_of(corner(set.corner_names[piece.first + c], on), -on.offset, on.normal));
        for (std::size_t c = 0; c < corners.size(); ++c)
          for (std::size_t k = 0; k < row; ++k)
            energy[footprint.tube * row + k] +=
                factor * of_edge(on, corners[c], corners[(c + 1) % corners.size()], k);
      }
    return energy;
  }

  /// The part of an edge in the integral over the polar angle. Corners are relative to the foot point.
  Real of_edge(const RealPlane& on, const RealVector& a, const RealVector& b, std::size_t bin) const {
    const RealVector along = sum_of(b, -1, a);
    const Real length = sqrt(dot_of(along, along));
    const Real aside = dot_of(on.normal, cross_of(a, along)) / length;
    const Real from = dot_of(a, along) / length, to = from + length;
    const Real least = limits_[bin], most = limits_[bin + 1], d = on.offset;
    const Real low = d < least ? least : d > most ? most : d;
    const Real clamped = antiderivative(low);
    const Real size = abs(aside);
    if (size < Real("1e-40")) return 0;
    std::vector<Real> cuts{from, to};
    const auto cut = [&](const Real& x) {
      for (const Real& place : {-x, x})
        if (place > from && place < to) cuts.push_back(place);
    };
    for (const Real& border : {least, most})
      if (const Real square = border * border - d * d - aside * aside; square > 0) cut(sqrt(square));
    const Real farthest = abs(from) > abs(to) ? abs(from) : abs(to);
    for (Real x = size / 2; x < farthest; x *= 2) cut(x);
    std::sort(cuts.begin(), cuts.end());
    Real sum = 0;
    for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
      const Real &x0 = cuts[k], &x1 = cuts[k + 1], middle = (x0 + x1) / 2;
      const Real r2 = d * d + aside * aside + middle * middle;
      if (r2 <= least * least) continue;
      if (r2 >= most * most)
        sum += (antiderivative(most) - clamped) * atan2(aside * (x1 - x0), aside * aside + x0 * x1);
      else
        sum += real_rule()(x0, x1, [&](const Real& x) {
          const Real square = aside * aside + x * x;
          return (antiderivative(sqrt(d * d + square)) - clamped) * aside / square;
        });
    }
    return sum;
  }

  const FacetMesh& mesh_;
  const History& history_;
  std::vector<Real> borders_, limits_;
  Real mu_, absorption_, beta_ = 0, moved_ = 0;
  const RealMotion* motion_ = nullptr;
};

}  // namespace tubefoot::test
