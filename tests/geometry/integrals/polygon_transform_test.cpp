// SPDX-License-Identifier: GPL-3.0-or-later
// Tests integrals of e^{i phase} over polygons. The comparisons are closed forms, values of the signals
// sheet, laws, and the series against the quotient.
#include "geometry/integrals/polygon_transform.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <random>

#include "fixtures/geometry/plane_polygons.hpp"
#include "geometry/integrals/gauss_rules.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

using test::Polygon2;
using Complex = std::complex<double>;

std::vector<glm::dvec2> offsets(const Polygon2& polygon) {
  std::vector<glm::dvec2> result;
  for (const glm::dvec2& p : polygon) result.push_back(p - polygon[0]);
  return result;
}

Complex transform(const Polygon2& polygon, glm::dvec2 q) {
  return phasor(glm::dot(q, polygon[0])) * polygon_transform(offsets(polygon), q);
}

double sinc(double x) { return x == 0 ? 1 : std::sin(x) / x; }

/// Computes the mean by Gauss's rule in each direction of a triangle, for phases that change by a few
/// radians.
Complex by_quadrature(double a, double b, double c) {
  const GaussRule& rule = gauss_rule(24);
  Complex sum = 0;
  for (std::size_t i = 0; i < 24; ++i)
    for (std::size_t j = 0; j < 24; ++j) {
      const double s = (1 + rule.node[i]) / 2, t = (1 + rule.node[j]) / 2;
      sum += rule.weight[i] * rule.weight[j] / 2 * s * phasor(a + s * (b - a) + s * t * (c - b));
    }
  return sum;
}

// Small phases and large ones, equal ones and nearly equal ones.
TEST(MeanPhasor, IsTheMeanForAllPhases) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> exponent(-9, 1), sign(-1, 1);
  for (int k = 0; k < 20000; ++k) {
    const auto phase = [&] { return sign(random) * std::pow(10, exponent(random)); };
    const double a = phase(), b = k % 3 == 0 ? a + 1e-9 * sign(random) : phase(),
                 c = k % 7 == 0 ? b : phase();
    ASSERT_LT(std::abs(mean_phasor(a, b, c) - by_quadrature(a, b, c)), 3e-15) << a << " " << b << " " << c;
    ASSERT_EQ(mean_phasor(a, a, a), phasor((a + a + a) / 3));
  }
}

// At the border between series and quotient both are accurate.
TEST(MeanPhasor, SeriesMeetsQuotient) {
  for (const double largest : {1.4999, 1.5001, 2.999, 3.001})
    for (double part = -0.5; part <= 0.5; part += 0.01) {
      const double a = largest, b = -largest * (0.5 + part), c = -largest * (0.5 - part);
      ASSERT_LT(std::abs(mean_phasor(a, b, c) - by_quadrature(a, b, c)), 2e-15);
    }
}

TEST(PolygonTransform, RectangleIsAProductOfSincs) {
  const double a = 0.10, b = 0.06;
  const Polygon2 rectangle{{-a / 2, -b / 2}, {a / 2, -b / 2}, {a / 2, b / 2}, {-a / 2, b / 2}};
  for (double qx = 0; qx < 3000; qx = qx == 0 ? 1e-6 : 3 * qx)
    for (double qy = 0; qy < 3000; qy = qy == 0 ? 1e-6 : 3 * qy)
      ASSERT_LT(std::abs(transform(rectangle, {qx, qy}) - a * b * sinc(qx * a / 2) * sinc(qy * b / 2)),
                2e-15 * a * b)
          << qx << " " << qy;
}

// The rectangle of 0.10 m by 0.06 m of the signals sheet, from three monostatic directions and one bistatic
// pair: f = (ik / 4 pi) (i - s).n I(k (i - s)), rigid.
TEST(PolygonTransform, RectangleHasTheSheetsDigits) {
  const double k = 2 * std::numbers::pi * 100e3 / 1500;
  EXPECT_NEAR(k, 418.879020479, 5e-10);
  const std::vector<glm::dvec3> rectangle{{-.05, -.03, 0}, {.05, -.03, 0}, {.05, .03, 0}, {-.05, .03, 0}};
  const auto towards = [&](double theta, double phi) {
    return glm::dvec3(std::sin(theta * degree) * std::cos(phi * degree),
                      std::sin(theta * degree) * std::sin(phi * degree), std::cos(theta * degree));
  };
  const auto length = [&](glm::dvec3 in, glm::dvec3 out) {
    return Complex(0, k / (4 * std::numbers::pi)) * (in - out).z *
           polygon_transform(rectangle, {0, 0, 1}, k * (in - out));
  };
  const auto check = [&](double theta, double phi, double rigid, double within, double strength_db,
                         double within_db) {
    const Complex f = length(-towards(theta, phi), towards(theta, phi));
    EXPECT_NEAR(f.imag(), rigid, within) << theta;
    EXPECT_NEAR(f.real(), 0, 1e-16) << theta;
    EXPECT_NEAR(20 * std::log10(std::abs(f)), strength_db, within_db) << theta;
  };
  check(0, 0, -0.4, 1e-15, -7.958800173, 5e-10);
  check(5, 0, 0.0532057710108715, 1e-15, -25.48082518, 5e-9);
  check(20, 30, -0.00102316471765103, 1e-16, -59.80108889, 5e-9);
  // Incidence at 30 degrees in the plane of x and z, scattering at 40 degrees, 15 degrees out of this
  // plane.
  const Complex beside =
      length(glm::dvec3(std::sin(30 * degree), 0, -std::cos(30 * degree)), towards(40, 15));
  EXPECT_NEAR(beside.imag(), -0.0306517890946051, 1e-15);
  EXPECT_NEAR(beside.real(), 0, 1e-16);
}

// Values of the signals sheet.
TEST(PolygonTransform, TriangleInSpaceHasTheSheetsDigits) {
  const double k = 2 * std::numbers::pi * 100e3 / 1500;
  const std::vector<glm::dvec3> triangle{{0, 0, 0}, {.09, .01, 0}, {.02, .07, .03}};
  const glm::dvec3 normal = glm::normalize(glm::cross(triangle[1], triangle[2]));
  const auto check = [&](glm::dvec3 to_sonar, Complex transform, Complex rigid) {
    const Complex got = polygon_transform(triangle, normal, -2 * k * to_sonar);
    EXPECT_LT(std::abs(got - transform), 2e-19);
    EXPECT_LT(std::abs(Complex(0, k / (2 * std::numbers::pi)) * glm::dot(-to_sonar, normal) * got - rigid),
              1e-17);
  };
  check(glm::dvec3(3, 4, 12) / 13.0, {-4.23329346106459e-6, -6.69441802932713e-6},
        {-3.25434199600731e-4, 2.05792118619016e-4});
  check(glm::dvec3(2, -1, 2) / 3.0, {-2.36032206912852e-5, -1.88870794050198e-5},
        {-9.74238424535869e-4, 1.21750769651228e-3});
}

// Laws Q1 and Q2.
TEST(PolygonTransform, PartsAddUpAndShiftsTurnThePhase) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int k = 0; k < 3000; ++k) {
    const double thin = std::pow(10, -8 * unit(random) * (k % 2));
    const Polygon2 polygon = test::random_convex(random, {3, -2}, 1, thin);
    const double size = std::pow(10, -6 + 9 * unit(random)), turn = 7 * unit(random);
    const glm::dvec2 q = size * glm::dvec2(std::cos(turn), std::sin(turn));
    // From a corner to a point of a far edge: two convex parts.
    const std::size_t n = polygon.size(), far = 1 + static_cast<std::size_t>(unit(random) * double(n - 2));
    const double t = unit(random);
    const glm::dvec2 cut = polygon[far] + t * (polygon[far + 1] - polygon[far]);
    Polygon2 one(polygon.begin(), polygon.begin() + long(far) + 1), other{polygon[0], cut};
    one.push_back(cut);
    other.insert(other.end(), polygon.begin() + long(far) + 1, polygon.end());
    double area = 0;
    for (std::size_t i = 2; i < n; ++i) {
      const glm::dvec2 a = polygon[i - 1] - polygon[0], b = polygon[i] - polygon[0];
      area += std::abs(a.x * b.y - a.y * b.x) / 2;
    }
    // The position of the cut is rounded, which changes the phase and the area of a needle.
    const double slack = area * (1e-14 + 5e-15 * size) + 3e-15;
    EXPECT_LT(std::abs(transform(polygon, q) - transform(one, q) - transform(other, q)), slack);
    const glm::dvec2 by{0.5, -0.25};
    EXPECT_LT(
        std::abs(transform(test::shifted(polygon, by), q) - phasor(glm::dot(q, by)) * transform(polygon, q)),
        slack);
    const Polygon2 turned(polygon.rbegin(), polygon.rend());
    EXPECT_LT(std::abs(transform(turned, q) + transform(polygon, q)), slack);
  }
}

}  // namespace
}  // namespace tubefoot
