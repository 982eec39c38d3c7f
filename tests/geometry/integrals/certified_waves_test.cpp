// SPDX-License-Identifier: GPL-3.0-or-later
// Tests waves over polygons in ball arithmetic. The balls contain the values of the signals sheet and the
// results in doubles.
#include "geometry/integrals/certified_waves.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <random>

#include "fixtures/geometry/balls.hpp"
#include "fixtures/geometry/plane_polygons.hpp"
#include "geometry/integrals/edge_form.hpp"
#include "geometry/integrals/polygon_transform.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

using test::Polygon2;
using Complex = std::complex<double>;
using test::k_100khz;
using test::outside;
using test::points;
using test::radius;

Complex in_doubles(const Polygon2& polygon, double height, const PathCutter::Receiver& rx, double k) {
  PlanarPolygon planar;
  planar.distance = height;
  planar.first = polygon[0];
  for (const glm::dvec2& p : polygon) planar.offsets.push_back(p - polygon[0]);
  Complex sum = 0;
  EdgeForm form([k](double path, std::span<Complex> values) { values[0] = phasor(k * path); }, 1, k);
  form.add(planar, rx, std::span(&sum, 1));
  return sum;
}

TEST(CertifiedMeanPhasor, HoldsWhatDoublesHaveAndIsNarrow) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> exponent(-9, 3), sign(-1, 1);
  for (int n = 0; n < 3000; ++n) {
    const auto phase = [&] { return sign(random) * std::pow(10, exponent(random)); };
    const double a = phase(), b = n % 3 == 0 ? a + 1e-9 * sign(random) : phase(),
                 c = n % 7 == 0 ? b : phase();
    const ComplexBall ball = certified_mean_phasor({Ball(a), Ball(b), Ball(c)});
    ASSERT_LT(outside(ball, mean_phasor(a, b, c)), 1e-15 * (2 + std::abs(a) + std::abs(b) + std::abs(c)));
    ASSERT_LT(radius(ball), 1e-15);  // due to the outward rounding of the double
  }
  // The series and the quotient compute the same number, so that their balls intersect.
  const Ball a(0.3), b(1.1), wide = Ball::between(2.2999, 2.3001);
  EXPECT_EQ(outside(certified_mean_phasor({a, b, wide}), mean_phasor(0.3, 1.1, 2.3)), 0);
  EXPECT_EQ(outside(certified_mean_phasor({a, b, Ball::between(1.1, 2.5)}), mean_phasor(0.3, 1.1, 2.3)), 0);
}

TEST(CertifiedTransform, HoldsTheRectangle) {
  const double a = 0.10, b = 0.06;
  const Polygon2 rectangle{{-a / 2, -b / 2}, {a / 2, -b / 2}, {a / 2, b / 2}, {-a / 2, b / 2}};
  for (const double q : {0.0, 1e-9, 0.1, 30.0, 1000.0}) {
    const ComplexBall ball = certified_transform(points(rectangle), Ball(q), Ball(q / 3));
    const auto sinc = [](double x) { return x == 0 ? 1 : std::sin(x) / x; };
    EXPECT_LT(outside(ball, a * b * sinc(q * a / 2) * sinc(q / 3 * b / 2)), 1e-17);
    EXPECT_LT(radius(ball), 1e-17);
  }
}

TEST(CertifiedEdgeForm, HoldsTheSheetsDigits) {
  const Polygon2 square{{-.1, -.1}, {.1, -.1}, {.1, .1}, {-.1, .1}};
  const auto one = certified_edge_form(points(square), Ball(1.0), {Ball(1.0), Ball(0.0), Ball(0.0)},
                                       Ball(k_100khz), 1e-14);
  ASSERT_TRUE(one);
  EXPECT_LT(outside(*one, {-0.4338993602338, 0.2430891220881}), 1e-13);
  EXPECT_LT(radius(*one), 1e-13);
  Polygon2 seen;
  for (const glm::dvec2& p : square) seen.push_back(p - glm::dvec2(-.2, .05));
  const auto two =
      certified_edge_form(points(seen), Ball(1.0), {Ball(.8), Ball(.5), Ball(-.15)}, Ball(k_100khz), 1e-14);
  ASSERT_TRUE(two);
  EXPECT_LT(outside(*two, {0.318785111189, -0.343830832103}), 1e-12);
  EXPECT_LT(radius(*two), 1e-13);
}

// Doubles have the accuracy that edge_form.hpp states, near the specular point and far from it.
TEST(CertifiedEdgeForm, HoldsWhatDoublesHave) {
  std::mt19937_64 random(6);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int n = 0; n < 30; ++n) {
    const Polygon2 polygon =
        test::random_convex(random, {2 * unit(random) - 1, 2 * unit(random) - 1}, .3, .2);
    const double height = .3 + unit(random), k = 300 * unit(random);
    const PathCutter::Receiver rx{.3 + unit(random), {unit(random) - .5, unit(random) - .5}};
    const auto ball = certified_edge_form(
        points(polygon), Ball(height), {Ball(rx.distance), Ball(rx.foot.x), Ball(rx.foot.y)}, Ball(k), 1e-15);
    ASSERT_TRUE(ball);
    EXPECT_LT(radius(*ball), 2e-15);
    EXPECT_LT(outside(*ball, in_doubles(polygon, height, rx, k)), 2e-13);
  }
  // An edge through the specular point.
  const Polygon2 through{{0, -.1}, {.2, -.1}, {.2, .1}, {0, .1}};
  const auto ball =
      certified_edge_form(points(through), Ball(.5), {Ball(.5), Ball(0.0), Ball(0.0)}, Ball(100.0), 1e-15);
  ASSERT_TRUE(ball);
  EXPECT_LT(outside(*ball, in_doubles(through, .5, {.5, {0, 0}}, 100)), 1e-14);
}

TEST(CertifiedEdgeForm, RefusesEndsInThePlane) {
  const Polygon2 square{{-.1, -.1}, {.1, -.1}, {.1, .1}, {-.1, .1}};
  EXPECT_FALSE(
      certified_edge_form(points(square), Ball(0.0), {Ball(1.0), Ball(0.0), Ball(0.0)}, Ball(1.0), 1e-9));
  EXPECT_FALSE(certified_edge_form(points(square), Ball(1.0), {Ball::between(-1, 1), Ball(0.0), Ball(0.0)},
                                   Ball(1.0), 1e-9));
}

}  // namespace
}  // namespace tubefoot
