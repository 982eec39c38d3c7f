// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <boost/math/constants/constants.hpp>
#include <boost/multiprecision/gmp.hpp>
#include <boost/multiprecision/mpfr.hpp>
#include <cmath>
#include <functional>
#include <glm/vec3.hpp>
#include <type_traits>
#include <utility>
#include <vector>

#include "engine/scattering/range_samples.hpp"
#include "engine/visibility/history.hpp"
#include "geometry/mesh/facet_mesh.hpp"

// Energies and their derivatives in 50 digits, independent of the code under test. Corners follow from the
// definitions of their names, with points that move. Let dG/dr = r f(r). The energy of a range bin is the
// integral of G(r) - G(D) over the polar angle about the foot point. Ranges are clamped to the bin.
namespace tubefoot::test {

using Real = boost::multiprecision::number<
    boost::multiprecision::mpfr_float_backend<50, boost::multiprecision::allocate_stack>,
    boost::multiprecision::et_off>;
using Rational =
    boost::multiprecision::number<boost::multiprecision::gmp_rational, boost::multiprecision::et_off>;

template <class N>
using VectorOf = std::array<N, 3>;
using RealVector = VectorOf<Real>;
using RationalVector = VectorOf<Rational>;

template <class N>
N dot_of(const VectorOf<N>& a, const VectorOf<N>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
template <class N>
VectorOf<N> cross_of(const VectorOf<N>& a, const VectorOf<N>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
/// a + factor b.
template <class N>
VectorOf<N> sum_of(const VectorOf<N>& a, const std::type_identity_t<N>& factor, const VectorOf<N>& b) {
  return {a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]};
}
template <class N>
VectorOf<N> vector_of(glm::dvec3 v) {
  return {N(v.x), N(v.y), N(v.z)};
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

/// Places of points relative to the apex: vertices in metres, rays in their own unit.
template <class N>
using Places = std::function<VectorOf<N>(PointId)>;

/// Places of the points of a history at rest.
template <class N>
Places<N> places_at_rest(const FacetMesh& mesh, const History& history) {
  return [&mesh, &history](PointId id) {
    const GridPoint p = id & ray_bit ? history.footprints.name_rays[id & ~ray_bit] : mesh.vertices[id];
    if (id & ray_bit) return VectorOf<N>{N(p.x), N(p.y), N(p.z)};
    const GridPoint apex = history.tubes.apex;
    const N unit(history.grid_unit_m);
    return VectorOf<N>{unit * (N(p.x) - apex.x), unit * (N(p.y) - apex.y), unit * (N(p.z) - apex.z)};
  };
}

/// Corners and planes by names alone.
template <class N>
class CornersOfNames {
 public:
  struct Plane {
    VectorOf<N> normal;
    N offset;
  };

  CornersOfNames(const FacetMesh& mesh, Places<N> point) : mesh_(mesh), point_(std::move(point)) {}

  Plane plane(FacetId facet) const {
    const auto& [a, b, c] = mesh_.facets[facet];
    const VectorOf<N> first = point_(a);
    const VectorOf<N> normal = cross_of(sum_of(point_(b), -1, first), sum_of(point_(c), -1, first));
    return {normal, dot_of(normal, first)};
  }
  VectorOf<N> corner(const CornerName& name, const Plane& on) const {
    const VectorOf<N> ray =
        name.point != no_point ? point_(name.point) : cross_of(normal(name.p), normal(name.q));
    return sum_of({N(0), N(0), N(0)}, on.offset / dot_of(on.normal, ray), ray);
  }

 private:
  /// On a depth plane, the planes of both facets have the same depth along each ray.
  VectorOf<N> normal(const PlaneName& name) const {
    if (!name.depth) return cross_of(point_(name.a), point_(name.b));
    const Plane one = plane(name.a), other = plane(name.b);
    VectorOf<N> scaled{};
    for (std::size_t k = 0; k < 3; ++k)
      scaled[k] = one.normal[k] / one.offset - other.normal[k] / other.offset;
    return scaled;
  }

  const FacetMesh& mesh_;
  Places<N> point_;
};

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

  /// Returns the derivatives of the energies, [tube][sample]. They are central differences of order 4 with a
  /// step of 1e-9.
  std::vector<Real> derivatives(const RealMotion& motion) {
    const Real step("1e-9");
    const Places<Real> rest = places_at_rest<Real>(mesh_, history_);
    std::vector<Real> sum(history_.tubes.tubes.size() * (borders_.size() - 1));
    for (const auto& [place, weight] : {std::pair{-2, 1}, {-1, -8}, {1, 8}, {2, -1}}) {
      const Real moved = place * step;
      const std::vector<Real> energy = energies<Real>(
          [&](PointId id) {
            const RealVector at = rest(id);
            return motion.velocity ? sum_of(at, moved, motion.velocity(id, at)) : at;
          },
          {moved * motion.by_absorption, moved * motion.by_range_scale, moved * motion.by_mu});
      for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += weight * energy[k] / (12 * step);
    }
    return sum;
  }

  /// Changes of numbers: of the absorption, of all range borders relatively, and of Lambert's parameter.
  struct Changes {
    Real absorption = 0, range_scale = 0, mu = 0;
  };
  /// Returns the energies for points at other places, [tube][sample]. Names stay the same. Corners are exact
  /// if the numbers are rational.
  template <class N>
  std::vector<Real> energies(const Places<N>& places, const Changes& changes) {
    const CornersOfNames<N> named(mesh_, places);
    beta_ = (absorption_ + changes.absorption) * log(Real(10)) / 10;
    const Real mu = mu_ + changes.mu;
    limits_.clear();
    for (const Real& border : borders_) limits_.push_back(border * (1 + changes.range_scale));
    const std::size_t row = borders_.size() - 1;
    std::vector<Real> energy(history_.tubes.tubes.size() * row);
    const FootprintSet& set = history_.footprints;
    for (const Footprint& footprint : set.footprints)
      for (std::uint32_t p = 0; p < footprint.piece_count; ++p) {
        const Piece& piece = set.pieces[footprint.first_piece + p];
        const auto exact = named.plane(footprint.facet);
        RealVector normal = real(exact.normal);
        Real offset(exact.offset), length = sqrt(dot_of(normal, normal));
        if (offset < 0) length = -length;  // the unit normal points away from the apex
        for (Real& x : normal) x /= length;
        offset /= length;
        const Real factor = mu * offset * offset;
        std::vector<RealVector> corners;
        for (std::uint32_t c = 0; c < piece.count; ++c)
          corners.push_back(
              sum_of(real(named.corner(set.corner_names[piece.first + c], exact)), -offset, normal));
        for (std::size_t c = 0; c < corners.size(); ++c)
          for (std::size_t k = 0; k < row; ++k)
            energy[footprint.tube * row + k] +=
                factor * of_edge(normal, offset, corners[c], corners[(c + 1) % corners.size()], k);
      }
    return energy;
  }

 private:
  template <class N>
  static RealVector real(const VectorOf<N>& v) {
    return {Real(v[0]), Real(v[1]), Real(v[2])};
  }

  /// Returns the integral of s^-5 e^(-2 beta s) from infinity to r. It is -r^-4 E_5(2 beta r), with the
  /// series of the exponential integral (Abramowitz and Stegun 5.1.12).
  Real antiderivative(const Real& r) const {
    static const Real tiny("1e-55"), euler = boost::math::constants::euler<Real>();
    const Real r4 = r * r * r * r;
    if (beta_ == 0) return -1 / (4 * r4);
    const Real x = 2 * beta_ * r;
    Real power = 1, sum = 0;  // power: (-x)^m / m!
    for (int m = 0; m < 200 && (m <= 5 || abs(power) > tiny); ++m) {
      if (m == 4)
        sum -= power * (log(x) + euler - Real(25) / 12);
      else
        sum -= power / (m - 4);
      power *= -x / (m + 1);
    }
    return -sum / r4;
  }

  /// The part of an edge in the integral over the polar angle. Corners are relative to the foot point, and
  /// `d` is its distance from the apex.
  Real of_edge(const RealVector& normal, const Real& d, const RealVector& a, const RealVector& b,
               std::size_t bin) const {
    const RealVector along = sum_of(b, -1, a);
    const Real length = sqrt(dot_of(along, along));
    const Real aside = dot_of(normal, cross_of(a, along)) / length;
    const Real from = dot_of(a, along) / length, to = from + length;
    const Real least = limits_[bin], most = limits_[bin + 1];
    const Real size = abs(aside);
    if (size < 1e-40) return 0;
    const Real farthest = abs(from) > abs(to) ? abs(from) : abs(to);
    const Real farthest2 = d * d + aside * aside + farthest * farthest;
    if (farthest2 <= least * least) return 0;
    const Real low = d < least ? least : d > most ? most : d;
    const Real clamped = antiderivative(low);
    std::vector<Real> cuts{from, to};
    const auto cut = [&](const Real& x) {
      for (const Real& place : {Real(-x), x})
        if (place > from && place < to) cuts.push_back(place);
    };
    for (const Real& border : {least, most})
      if (const Real square = border * border - d * d - aside * aside; square > 0) cut(sqrt(square));
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
  Real mu_, absorption_, beta_ = 0;
};

}  // namespace tubefoot::test
