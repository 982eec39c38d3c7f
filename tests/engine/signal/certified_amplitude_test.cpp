// SPDX-License-Identifier: GPL-3.0-or-later
// Compares near-field amplitudes in ball arithmetic with the surface integral in 30 digits. The integral
// uses a product of Gauss rules over triangles and no edge form.
#include "engine/signal/certified_amplitude.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <complex>
#include <random>

#include "engine/signal/smooth_amplitude.hpp"
#include "fixtures/geometry/plane_polygons.hpp"

namespace tubefoot {
namespace {

using Real = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<35>>;
using Rule = boost::math::quadrature::gauss<Real, 30>;
using Complex = std::complex<double>;
using test::Polygon2;

std::vector<CertifiedPolygon::Point> points(const Polygon2& polygon) {
  std::vector<CertifiedPolygon::Point> result;
  for (const glm::dvec2& p : polygon) result.push_back({Ball(p.x), Ball(p.y)});
  return result;
}

/// The integral of the normal derivative of e^{ikr}/r e^{iks}/s over 4 pi, R = 1.
std::pair<Real, Real> surface_integral(const Polygon2& polygon, double height, double rx_height,
                                       glm::dvec2 foot, double k) {
  const Real h(height), g(rx_height), wave(k);
  Real re = 0, im = 0;
  const auto add = [&](const Real& x, const Real& y, const Real& weight) {
    const Real r = sqrt(x * x + y * y + h * h), dx = x - Real(foot.x), dy = y - Real(foot.y),
               s = sqrt(dx * dx + dy * dy + g * g);
    const Real c = cos(wave * (r + s)), d = sin(wave * (r + s));
    // -(h (ik - 1/r) / (r^2 s) + g (ik - 1/s) / (s^2 r)) e^{ik(r + s)}
    const Real a = h / (r * r * r * s) + g / (s * s * s * r), b = -wave * (h / (r * r * s) + g / (s * s * r));
    re += weight * (a * c - b * d);
    im += weight * (a * d + b * c);
  };
  std::vector<std::pair<Real, Real>> nodes;  // on [0, 1]
  for (std::size_t i = 0; i < Rule::abscissa().size(); ++i)
    for (const int sign : {-1, 1})
      nodes.emplace_back((1 + sign * Rule::abscissa()[i]) / 2, Rule::weights()[i] / 2);
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    const Real ax(polygon[0].x), ay(polygon[0].y),
        bx = Real(polygon[i - 1].x) - ax, by = Real(polygon[i - 1].y) - ay, cx = Real(polygon[i].x) - ax,
        cy = Real(polygon[i].y) - ay;
    const Real twice = bx * cy - by * cx;
    for (const auto& [u, wu] : nodes)
      for (const auto& [v, wv] : nodes)
        add(ax + u * ((1 - v) * bx + v * cx), ay + u * ((1 - v) * by + v * cy), twice * u * wu * wv);
  }
  const Real four_pi = 16 * atan(Real(1));
  return {re / four_pi, im / four_pi};
}

bool holds(const ComplexBall& ball, const std::pair<Real, Real>& value) {
  const auto in = [](const Ball& b, const Real& x) { return Real(b.lo()) <= x && x <= Real(b.hi()); };
  return in(ball.real(), value.first) && in(ball.imaginary(), value.second);
}
double width(const ComplexBall& ball) {
  return std::max(ball.real().hi() - ball.real().lo(), ball.imaginary().hi() - ball.imaginary().lo());
}

// Law Q11. The polygons lie far from the point of the shortest path, about it, and at grazing angles of a
// degree or less. The cases include one end, two ends, and needles.
TEST(CertifiedAmplitude, HoldsTheSurfaceIntegral) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int n = 0; n < 24; ++n) {
    const Polygon2 polygon =
        test::random_convex(random, {4 * unit(random) - 2, 4 * unit(random) - 2}, .2, n % 4 == 0 ? 1e-5 : .1);
    const double height = n % 3 == 0 ? 0.4 + 0.1 * unit(random) : 1 + unit(random), k = 40 * unit(random);
    const bool one = n % 2 == 0;
    const double rx_height = one ? height : 0.5 + unit(random);
    const glm::dvec2 foot = one ? glm::dvec2(0) : glm::dvec2(unit(random), -unit(random));
    const auto ball = certified_amplitude(points(polygon), Ball(height),
                                          {Ball(rx_height), Ball(foot.x), Ball(foot.y)}, {}, Ball(k), 1e-15);
    ASSERT_TRUE(ball);
    EXPECT_TRUE(holds(*ball, surface_integral(polygon, height, rx_height, foot, k))) << n;
    EXPECT_LT(width(*ball), 1e-13);
  }
}

// With reflection and roughness, where angles vary, the doubles of `SmoothAmplitude` lie within their
// stated error.
TEST(CertifiedAmplitude, HoldsDoublesOfSurfaces) {
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> unit(0, 1);
  for (const SmoothSurface& surface : {SmoothSurface{}, SmoothSurface{-0.5, std::nullopt, 4e-3},
                                       SmoothSurface{1, FluidSediment{1.9, 1.2, 0}, 0},
                                       SmoothSurface{1, FluidSediment{1.5, 0.95, 0.02}, 1e-3}})
    for (int n = 0; n < 12; ++n) {
      // Every third polygon contains the point of the shortest path.
      const Polygon2 polygon = test::random_convex(
          random, n % 3 == 0 ? glm::dvec2(0) : glm::dvec2(8 * unit(random) - 4, 8 * unit(random) - 4), .3,
          .2);
      const double height = .3 + unit(random), k = 200 * unit(random) + 1;
      const PathCutter::Receiver rx{.3 + unit(random), {unit(random) - .5, unit(random) - .5}};
      const ApexOverPlane end{Ball(rx.distance), Ball(rx.foot.x), Ball(rx.foot.y)};
      const auto ball = certified_amplitude(points(polygon), Ball(height), end, surface, Ball(k), 1e-14);
      ASSERT_TRUE(ball);
      const PlanarPolygon planar = test::planar(polygon, height);
      Complex sum = 0;
      SmoothAmplitude(std::span(&k, 1), 0).add(planar, rx, surface, std::span(&sum, 1));
      const Complex middle(ball->real().middle(), ball->imaginary().middle());
      EXPECT_LT(std::abs(sum - middle), 2e-12 + width(*ball)) << n;
      EXPECT_LT(width(*ball), 1e-12);
      const Ball sine = certified_mean_sine(points(polygon), Ball(height), end);
      EXPECT_NEAR(sine.middle(), mean_sine(planar, rx), 1e-12);
      EXPECT_LT(sine.hi() - sine.lo(), 1e-12);
    }
}

// Uncertain corners make a wide interval that contains the true value. If the tolerance cannot be met,
// there is no result.
TEST(CertifiedAmplitude, IsAsWideAsItsCorners) {
  const Polygon2 square{{-.1, -.1}, {.1, -.1}, {.1, .1}, {-.1, .1}};
  const ApexOverPlane end{Ball(1.0), Ball(0.0), Ball(0.0)};
  std::vector<CertifiedPolygon::Point> rough = points(square);
  for (CertifiedPolygon::Point& p : rough) {
    p.x.add_error(Ball(1e-6));
    p.y.add_error(Ball(1e-6));
  }
  const SmoothSurface surface{1, FluidSediment{1.9, 1.2, 0}, 1e-3};
  const auto wide = certified_amplitude(rough, Ball(1.0), end, surface, Ball(40.0), 1e-6);
  ASSERT_TRUE(wide);
  EXPECT_GT(width(*wide), 1e-7);
  EXPECT_LT(width(*wide), 1e-2);
  const auto fine = certified_amplitude(points(square), Ball(1.0), end, surface, Ball(40.0), 1e-15);
  ASSERT_TRUE(fine);
  EXPECT_TRUE(holds(*wide, {Real(fine->real().middle()), Real(fine->imaginary().middle())}));
  EXPECT_FALSE(certified_amplitude(points(square), Ball(0.0), end, surface, Ball(40.0), 1e-9));
  EXPECT_FALSE(certified_amplitude(points(square), Ball(1.0), end, surface, Ball(40.0), 0));
}

}  // namespace
}  // namespace tubefoot
