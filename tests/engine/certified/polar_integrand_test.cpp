// SPDX-License-Identifier: GPL-3.0-or-later
// Tests PolarIntegrand with dual numbers: derivatives of the energy of one footprint. Corners, slab borders
// and the integrand depend on the parameters, so the derivative contains the terms of moving boundaries. The
// values are compared with the bounds of the same template in balls and in intervals.
#include "engine/certified/polar_integrand.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include "engine/certified/interval_integral.hpp"
#include "geometry/integrals/gauss_rules.hpp"
#include "geometry/integrals/polar_numbers.hpp"

namespace tubefoot {
namespace {

using std::numbers::pi;

template <std::size_t n>
using DualPolygon = PolarPolygon<Dual<n>, Dual<n>>;
/// A polygon at a distance from the apex, counter-clockwise.
template <class Number>
using Corners = std::vector<std::pair<Number, Number>>;

template <class Numbers, class Polygon, class Number>
Polygon polygon_of(const Number& distance, const Corners<Number>& corners) {
  Polygon polygon;
  polygon.distance = distance;
  for (const auto& [x, y] : corners) polygon.points.push_back({x, y});
  finish<Numbers>(polygon);
  return polygon;
}

/// The integral of density / (mu distance^2) of Lambert's law over the part of a polygon between two ranges.
template <std::size_t n>
Dual<n> integral(const Dual<n>& distance, const Corners<Dual<n>>& corners, double beta,
                 const std::array<double, 2>& borders) {
  constexpr int panels = 16;
  using Numbers = DualNumbers<n>;
  const auto polygon = polygon_of<Numbers, DualPolygon<n>>(distance, corners);
  PolarSlabs slabs;
  slabs.cut(polygon.ranges, polygon.foot, polygon.foot_inside, borders);
  // Ranges at which the arcs change move with the parameters. The borders are constant.
  std::map<long double, Dual<n>> moving{{distance.value, distance}};
  const auto add = [&](const Dual<n>& range) { moving.emplace(range.value, range); };
  for (const auto& p : polygon.points) add(root(squared(distance) + squared(p.x) + squared(p.y)));
  for (const auto& edge : polygon.edges) add(root(edge.nearest2));
  const auto end_at = [&](long double range) {
    const auto known = moving.find(range);
    return known == moving.end() ? Dual<n>(range) : known->second;
  };
  PolarIntegrand<Numbers> integrand(beta);
  integrand.take_polygon(polygon);
  const GaussRule& rule = gauss_rule(most_gauss_nodes);
  Dual<n> sum;
  for (const PolarSlabs::Slab& slab : slabs.slabs()) {
    EXPECT_TRUE(integrand.prepare(slabs.crossings(slab), slab));
    const Dual<n> from = integrand.t_at(end_at(slab.lo)), to = integrand.t_at(end_at(slab.hi));
    const Dual<n> half = (to - from) / (2 * panels);
    for (int k = 0; k < panels; ++k)
      sum += integrand.by_rule(from + (2 * k + 1) * half, half, rule.node, rule.weight);
  }
  return sum;
}

/// Compares a derivative with the central difference of `energy`, a function of the parameter. The change
/// between two step widths is three times the error of the smaller one, up to fourth order.
template <class Energy>
void expect_central_difference(double derivative, double at, double step, const Energy& energy) {
  const auto difference = [&](double s) { return (energy(at + s) - energy(at - s)) / (2 * s); };
  const double near = difference(step), error = std::abs(difference(2 * step) - near) / 3;
  const double rounding = 1e-14 * std::abs(energy(at)) / step;
  EXPECT_NEAR(derivative, near, 1.5 * error + rounding);
  EXPECT_LT(error, 1e-4 * std::abs(derivative));
}

TEST(PolarIntegrand, DiscAboutFootPoint_DerivativeByHeightIsThatOfClosedForm) {
  const double mu = std::pow(10, -2.7), height = 3, farthest = 6;
  const auto h = Dual<1>::parameter(height, 0);
  const Corners<Dual<1>> square{{-9, -9}, {9, -9}, {9, 9}, {-9, 9}};
  const Dual<1> energy = mu * squared(h) * integral<1>(h, square, 0, {1, farthest});
  // The plane within range R has the energy mu pi / 2 (h^-2 - h^2 R^-4).
  const double far4 = std::pow(farthest, -4);
  EXPECT_NEAR(energy.value, mu * pi / 2 * (1 / (height * height) - height * height * far4),
              1e-13 * energy.value);
  const double expected = -mu * pi * (std::pow(height, -3) + height * far4);
  EXPECT_NEAR(energy.derivative[0], expected, 1e-12 * std::abs(expected));
}

/// Seabed beyond the shadow of a wall. The shadow's end, which is a boundary of the footprint, moves with
/// height of the apex, height of the wall and distance of the wall.
template <std::size_t n>
Dual<n> beyond_shadow(const Dual<n>& apex, const Dual<n>& wall, const Dual<n>& away) {
  const double mu = std::pow(10, -2.7), farthest = 6, width = 1e-4;
  const Dual<n> shadow = away * apex / (apex - wall), side = std::tan(width / 2), outside = 10;
  const Corners<Dual<n>> corners{{shadow, -(shadow * side)},
                                 {outside, -(outside * side)},
                                 {outside, outside * side},
                                 {shadow, shadow * side}};
  return mu * squared(apex) * integral<n>(apex, corners, 0, {1, farthest}) * (0.01 / width);
}

TEST(PolarIntegrand, SeabedBeyondShadow_DerivativesContainMovingBoundary) {
  const double apex = 3, wall = 0.5, away = 4;
  using Dual3 = Dual<3>;
  const Dual3 energy =
      beyond_shadow(Dual3::parameter(apex, 0), Dual3::parameter(wall, 1), Dual3::parameter(away, 2));
  // E = mu H^2 w (r_s^-4 - r_1^-4) / 4 for w = 0.01 rad, and its derivatives. The shadow of a straight wall
  // ends at a straight line instead of a circle. This changes energies by about 0.6 width^2, relatively.
  const double straight = 5e-8;
  const auto expect = [&](double found, double expected) {
    EXPECT_NEAR(found, expected, straight * std::abs(expected));
  };
  expect(energy.value, 9.091844360675e-9);
  expect(energy.derivative[0], -1.931701426985e-9);
  expect(energy.derivative[1], -5.031615580812e-8);
  expect(energy.derivative[2], -3.144759738007e-8);

  expect_central_difference(energy.derivative[0], apex, 1e-3,
                            [&](double x) { return beyond_shadow<0>(x, wall, away).value; });
  expect_central_difference(energy.derivative[1], wall, 1e-3,
                            [&](double x) { return beyond_shadow<0>(apex, x, away).value; });
  expect_central_difference(energy.derivative[2], away, 1e-3,
                            [&](double x) { return beyond_shadow<0>(apex, wall, x).value; });
}

/// A pentagon with an absorbing water. The parameter is one coordinate of one corner.
template <std::size_t n>
Corners<Dual<n>> pentagon(const Dual<n>& x) {
  return {{x, -1.5}, {4.5, 0.25}, {3.75, 2.5}, {1.25, 2.75}, {-0.5, 0.75}};
}

TEST(PolarIntegrand, Pentagon_ValueLiesInBoundsAndDerivativeIsCentralDifference) {
  const double height = 2, beta = 0.03, at = 1.25;
  const std::array<double, 2> borders{2.25, 4.75};
  const auto energy = integral<1>(height, pentagon(Dual<1>::parameter(at, 0)), beta, borders);
  expect_central_difference(energy.derivative[0], at, 1e-3, [&](double x) {
    return integral<0>(height, pentagon<0>(x), beta, borders).value;
  });

  const auto corners_in = [&]<class Number>(const Number&) {
    Corners<Number> corners;
    for (const auto& [x, y] : pentagon<0>(at)) corners.emplace_back(x.value, y.value);
    return corners;
  };
  const CertifiedIntegrator::Allowance allowance{1e-11, [](std::uint32_t, std::uint32_t) { return 1e-15; }};
  CertifiedIntegrator in_balls(borders, Ball(beta));
  Ball sure;
  in_balls.add(polygon_of<BallNumbers, CertifiedPolygon>(Ball(height), corners_in(Ball())), 0, allowance,
               [&](const Part<Ball>& part) { sure += part.value; });
  IntervalIntegrator in_intervals(borders, Interval(beta));
  std::vector<IntervalIntegrator::SamplePart> parts;
  ASSERT_TRUE(in_intervals.enclose(
      polygon_of<IntervalNumbers, IntervalPolygon>(FineInterval(height), corners_in(FineInterval())), 0,
      allowance, parts));
  Interval fast;
  for (const auto& part : parts) fast += part.value;
  const double rounding = 1e-13 * energy.value;
  EXPECT_GT(energy.value, sure.lo() - rounding);
  EXPECT_LT(energy.value, sure.hi() + rounding);
  EXPECT_GT(energy.value, fast.lo - rounding);
  EXPECT_LT(energy.value, fast.hi + rounding);
  EXPECT_LT(fast.width(), 1e-9 * energy.value);
}

}  // namespace
}  // namespace tubefoot
