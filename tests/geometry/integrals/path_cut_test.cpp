// SPDX-License-Identifier: GPL-3.0-or-later
// Tests areas between ellipses of equal path, for a transmitter and a separate receiver. The comparisons
// are closed forms (physics sheet 7.6) and random points.
#include "geometry/integrals/path_cut.hpp"

#include <gtest/gtest.h>

#include <boost/math/distributions/binomial.hpp>
#include <cmath>
#include <numeric>
#include <random>

#include "fixtures/geometry/plane_polygons.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

using test::planar;
using test::Polygon2;

/// Two points above a plane: their heights, and the foot point of the receiver relative to that of the
/// transmitter.
struct Apexes {
  double transmit_height, receive_height;
  glm::dvec2 receive_foot;
  double path(glm::dvec2 p) const {
    const glm::dvec2 q = p - receive_foot;
    return std::sqrt(transmit_height * transmit_height + glm::dot(p, p)) +
           std::sqrt(receive_height * receive_height + glm::dot(q, q));
  }
  double shortest() const { return std::hypot(transmit_height + receive_height, glm::length(receive_foot)); }
};

std::vector<double> areas(const Polygon2& corners, const Apexes& apexes, const std::vector<double>& borders) {
  std::vector<double> out(borders.size() - 1, 0);
  PathCutter cutter(borders);
  cutter.add(
      planar(corners, apexes.transmit_height), {apexes.receive_height, apexes.receive_foot},
      [](glm::dvec2, double, double, std::span<double> values) { values[0] = 1; }, {}, out);
  return out;
}

std::vector<double> even(double first, double step, int count) {
  std::vector<double> borders;
  for (int k = 0; k <= count; ++k) borders.push_back(first + k * step);
  return borders;
}

/// Area of the section of the plane with the spheroid of points with that path. The spheroid has the
/// semi-axes a and b (twice). The plane has distance p from the centre, and its normal has sine s along the
/// axis:
///   pi a b^2 (1 - p^2 / w) / sqrt(w), w = a^2 s^2 + b^2 (1 - s^2).
double ellipse_area(const Apexes& apexes, double path) {
  if (path <= apexes.shortest()) return 0;
  const double rise = apexes.transmit_height - apexes.receive_height;
  const double apart2 = rise * rise + glm::dot(apexes.receive_foot, apexes.receive_foot);
  const double a2 = path * path / 4, b2 = (path * path - apart2) / 4;
  const double sine2 = apart2 > 0 ? rise * rise / apart2 : 0;
  const double p = (apexes.transmit_height + apexes.receive_height) / 2;
  const double w = a2 * sine2 + b2 * (1 - sine2);
  return pi * std::sqrt(a2) * b2 * (1 - p * p / w) / std::sqrt(w);
}

// Law P1.
TEST(PathCut, BinsOfAPlaneAreDifferencesOfEllipses) {
  const Polygon2 plane{{-300, -280}, {310, -300}, {290, 300}, {-300, 310}};
  for (const Apexes& apexes :
       {Apexes{5, 5, {0, 0}}, Apexes{5, 2, {0, 0}}, Apexes{10, 10, {6, -3}}, Apexes{3, 8, {20, 15}},
        Apexes{0.5, 0.25, {30, 1}}, Apexes{12, 0.05, {-4, 9}}}) {
    const double least = apexes.shortest() / 2;
    // From before the first return to beyond it.
    const std::vector<double> borders = even(least - 0.3, 0.5, 150);
    const std::vector<double> got = areas(plane, apexes, borders);
    for (std::size_t k = 0; k < got.size(); ++k) {
      const double expected = ellipse_area(apexes, 2 * borders[k + 1]) - ellipse_area(apexes, 2 * borders[k]);
      ASSERT_NEAR(got[k], expected, 1e-10 * expected)
          << "sample " << k << ", heights " << apexes.transmit_height << ' ' << apexes.receive_height;
    }
  }
}

TEST(PathCut, PrintedAreasOfPolygonsAndCircles) {
  // Both apexes are at height 1 over the centre of the circle: a circle of radius r has the half path
  // sqrt(1 + r^2).
  const auto within = [](Polygon2 polygon, glm::dvec2 centre, double r) {
    return areas(test::shifted(std::move(polygon), -centre), {1, 1, {0, 0}}, {0, std::sqrt(1 + r * r)})[0];
  };
  const Polygon2 unit{{0, 0}, {1, 0}, {1, 1}, {0, 1}}, square{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}},
      triangle{{0, 0}, {4, 0}, {0, 3}};
  EXPECT_NEAR(within(unit, {0, 0}, 1), pi / 4, 1e-10);
  EXPECT_NEAR(within(square, {0, 0}, 1.2), 3.803644523140, 1e-10);
  EXPECT_NEAR(within(square, {1, 1}, 1), pi / 4, 1e-10);
  EXPECT_NEAR(within(square, {1, 0}, 1), pi / 2, 1e-10);
  EXPECT_NEAR(within(triangle, {1, 1}, 1), pi, 1e-10);
  EXPECT_NEAR(within(triangle, {0, 0}, 2), pi, 1e-10);
  EXPECT_NEAR(within(triangle, {2, 1.5}, 2.5), 6, 1e-9);
}

/// Signed area of the triangle (0, a, b) within the unit circle.
double triangle_in_circle(glm::dvec2 a, glm::dvec2 b) {
  const auto cross = [](glm::dvec2 p, glm::dvec2 q) { return p.x * q.y - p.y * q.x; };
  const auto sector = [&](glm::dvec2 p, glm::dvec2 q) { return std::atan2(cross(p, q), glm::dot(p, q)) / 2; };
  const glm::dvec2 d = b - a;
  const double dd = glm::dot(d, d), ad = glm::dot(a, d), c = glm::dot(a, a) - 1, disc = ad * ad - dd * c;
  if (disc <= 0) return sector(a, b);
  const double t0 = std::clamp((-ad - std::sqrt(disc)) / dd, 0.0, 1.0),
               t1 = std::clamp((-ad + std::sqrt(disc)) / dd, 0.0, 1.0);
  if (t0 == t1) return sector(a, b);
  const glm::dvec2 p = a + t0 * d, q = a + t1 * d;
  return sector(a, p) + cross(p, q) / 2 + sector(q, b);
}

/// Area of a polygon within the ellipse of a path. 4 L^2 |P-T|^2 - (L^2 + |P-T|^2 - |P-R|^2)^2 = 0 is a
/// conic, and an affine map transforms it into the unit circle.
double area_in_ellipse(const Polygon2& polygon, const Apexes& apexes, double path) {
  if (path <= apexes.shortest()) return 0;
  const glm::dvec2 f = apexes.receive_foot;
  const double ht = apexes.transmit_height, hr = apexes.receive_height;
  // |P-T|^2 - |P-R|^2 = 2 f.P + e
  const double e = ht * ht - hr * hr - glm::dot(f, f), l2 = path * path;
  // P.M.P - 2 g.P = h
  const double mxx = 4 * l2 - 4 * f.x * f.x, mxy = -4 * f.x * f.y, myy = 4 * l2 - 4 * f.y * f.y;
  const glm::dvec2 g = 2 * (l2 + e) * f;
  const double h = (l2 + e) * (l2 + e) - 4 * l2 * ht * ht, det = mxx * myy - mxy * mxy;
  const glm::dvec2 centre((myy * g.x - mxy * g.y) / det, (mxx * g.y - mxy * g.x) / det);
  const double size = h + glm::dot(g, centre);
  // Cholesky: M / size = U^T U, unit circle = U (P - centre).
  const double u11 = std::sqrt(mxx / size), u12 = mxy / size / u11, u22 = std::sqrt(myy / size - u12 * u12);
  const auto mapped = [&](glm::dvec2 p) {
    const glm::dvec2 q = p - centre;
    return glm::dvec2(u11 * q.x + u12 * q.y, u22 * q.y);
  };
  double sum = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i)
    sum += triangle_in_circle(mapped(polygon[i]), mapped(polygon[(i + 1) % polygon.size()]));
  return sum / (u11 * u22);
}

double area_of(const Polygon2& polygon) {
  double twice = 0;
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    const glm::dvec2 a = polygon[i - 1] - polygon[0], b = polygon[i] - polygon[0];
    twice += a.x * b.y - a.y * b.x;
  }
  return twice / 2;
}

// Law P3.
TEST(PathCut, PolygonsAnywhereAgreeWithTheAffineMapToACircle) {
  const unsigned seed = 31415;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(-20, 20), height(0.2, 12);
  for (int i = 0; i < 300; ++i) {
    const Apexes apexes{height(random), height(random), {place(random), place(random)}};
    const double size = i % 3 == 0 ? 0.05 : i % 3 == 1 ? 2 : 15;
    const Polygon2 polygon = test::random_convex(random, {place(random), place(random)}, size, size / 2);
    const double area = area_of(polygon);
    const std::vector<double> borders = even(0, i % 3 == 0 ? 0.005 : 0.25, i % 3 == 0 ? 8000 : 320);
    const std::vector<double> got = areas(polygon, apexes, borders);
    double sum = 0;
    for (std::size_t k = 0; k < got.size(); ++k) {
      sum += got[k];
      // thousands of empty bins; the sum below includes all bins that matter
      if (got[k] == 0 && i % 3 == 0) continue;
      const double expected = area_in_ellipse(polygon, apexes, 2 * borders[k + 1]) -
                              area_in_ellipse(polygon, apexes, 2 * borders[k]);
      // The oracle is a difference of areas of the size of the ellipse.
      const double rounding = 1e-14 * (40 * 40 + apexes.shortest() * apexes.shortest());
      ASSERT_NEAR(got[k], expected, 2e-10 * expected + rounding) << "polygon " << i << ", sample " << k;
    }
    EXPECT_NEAR(sum, area, 1e-10 * area + 1e-16 * 30 * size) << i;  // positions are rounded
  }
}

TEST(PathCut, ShortestPathInsideOnAnEdgeAndAtACorner) {
  // c = foot * 2 / 5
  const Apexes apexes{2, 3, {5, 0}};
  for (const glm::dvec2 corner :
       {glm::dvec2(-1, -1), {2, -1}, {2, 0}, {0, 0}, {2 - 1e-13, -1e-13}, {-0.5, 0}}) {
    const Polygon2 square = test::shifted({{0, 0}, {4, 0}, {4, 4}, {0, 4}}, corner);
    const std::vector<double> borders = even(0, 0.1, 80);
    const std::vector<double> got = areas(square, apexes, borders);
    for (std::size_t k = 0; k < got.size(); ++k)
      ASSERT_NEAR(got[k],
                  area_in_ellipse(square, apexes, 2 * borders[k + 1]) -
                      area_in_ellipse(square, apexes, 2 * borders[k]),
                  2e-10 * got[k] + 1e-12)
          << k;
  }
}

// Law P2.
TEST(PathCut, NeedlesAndCornersAtTheShortestPathAddUp) {
  // The cases are apexes micrometres from the plane, needles, and corners and edges within rounding of the
  // point of the shortest path. For any range bins, the areas add up to that of the polygon.
  const unsigned seed = 14142;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  const auto log_uniform = [&](double lo, double hi) { return lo * std::pow(hi / lo, unit(random)); };
  const auto towards = [&](double length) {
    const double angle = 2 * pi * unit(random);
    return length * glm::dvec2(std::cos(angle), std::sin(angle));
  };
  for (int i = 0; i < 200; ++i) {
    const double ht = log_uniform(1e-5, 100), hr = log_uniform(1e-5, 100);
    const Apexes apexes{ht, hr, i % 7 == 0 ? glm::dvec2(0) : towards(log_uniform(1e-6, 100))};
    const glm::dvec2 c = apexes.receive_foot * (ht / (ht + hr));
    const double size = log_uniform(1e-3, 100);
    Polygon2 polygon = test::random_convex(random, {0, 0}, size, size * log_uniform(1e-7, 1));
    if (i % 3 == 0) polygon = test::shifted(polygon, -polygon[0]);
    if (i % 3 == 1) polygon = test::shifted(polygon, -0.5 * (polygon[0] + polygon[1]));
    const glm::dvec2 places[] = {c, {0, 0}, apexes.receive_foot, towards(log_uniform(1e-3, 100))};
    polygon = test::shifted(polygon, places[i % 4] + towards(log_uniform(1e-16, 10)));
    std::vector<double> borders = even(0, size * log_uniform(1e-2, 1), 100);
    borders.push_back(1e6);
    double sum = 0, far = 0;
    for (const double part : areas(polygon, apexes, borders)) sum += part;
    for (const glm::dvec2& p : polygon) far = std::max(far, glm::length(p) + glm::length(p - c));
    const double area = area_of(polygon);
    EXPECT_NEAR(sum, area, 1e-10 * area + 1e-13 * far * size) << i;
  }
}

// Law P3.
TEST(PathCut, SharesOfRandomPointsAreBinomial) {
  const unsigned seed = 27182;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> side(0, 1);
  const Apexes apexes{3, 1, {7, 2}};
  const Polygon2 square{{-2, -3}, {8, -3}, {8, 7}, {-2, 7}};
  const std::vector<double> borders = even(4, 0.05, 40);
  const std::vector<double> got = areas(square, apexes, borders);
  constexpr int points = 400000;
  std::vector<int> count(got.size(), 0);
  for (int i = 0; i < points; ++i) {
    const glm::dvec2 p(-2 + 10 * side(random), -3 + 10 * side(random));
    const double half = apexes.path(p) / 2;
    for (std::size_t k = 0; k < got.size(); ++k) count[k] += half >= borders[k] && half < borders[k + 1];
  }
  for (std::size_t k = 0; k < got.size(); ++k) {
    if (got[k] == 0) {
      EXPECT_EQ(count[k], 0) << k;
      continue;
    }
    const boost::math::binomial_distribution<double> law(points, got[k] / 100);
    EXPECT_GT(cdf(law, count[k]), 1e-6) << k;
    EXPECT_GT(cdf(complement(law, std::max(count[k] - 1, 0))), 1e-6) << k;
  }
}

TEST(PathCut, TheSamplesOfAPolygonAreThoseItReachesInto) {
  const Apexes apexes{3, 1, {7, 2}};
  const Polygon2 square{{-2, -3}, {8, -3}, {8, 7}, {-2, 7}};
  const std::vector<double> borders = even(0, 0.05, 400);
  const std::vector<double> got = areas(square, apexes, borders);
  const auto [first, end] = PathCutter(borders).samples_of(planar(square, 3), {1, {7, 2}});
  for (std::size_t k = 0; k < got.size(); ++k)
    if (got[k] != 0) {
      EXPECT_GE(k, first);
      EXPECT_LT(k, end);
    }
  EXPECT_LT(end, 220u);
  EXPECT_GT(first, 60u);
}

// Compares with a fine grid of the polygon and its borders.
TEST(PathCut, TheShortestAndTheLongestHalfPathOfAPolygon) {
  const unsigned seed = 8128;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(-6, 6), height(0.05, 5);
  int inside = 0;
  for (int i = 0; i < 60; ++i) {
    const Apexes apexes{height(random), height(random), {place(random), place(random)}};
    const Polygon2 p = test::random_convex(random, {place(random), place(random)}, 4, 3);
    const auto [shortest, longest] = PathCutter::half_paths_of(planar(p, apexes.transmit_height),
                                                               {apexes.receive_height, apexes.receive_foot});
    double least = 1e9, most = 0;
    constexpr int n = 120;
    for (std::size_t t = 2; t < p.size(); ++t)
      for (int a = 0; a <= n; ++a)
        for (int b = 0; a + b <= n; ++b) {
          const double half =
              apexes.path(p[0] + (p[t - 1] - p[0]) * (double(a) / n) + (p[t] - p[0]) * (double(b) / n)) / 2;
          least = std::min(least, half);
          most = std::max(most, half);
        }
    EXPECT_LE(shortest, least * (1 + 1e-14)) << i;
    EXPECT_NEAR(shortest, least, 0.01) << i;
    EXPECT_NEAR(longest, most, 1e-12) << i;
    inside += std::abs(shortest - apexes.shortest() / 2) < 1e-12;
  }
  EXPECT_GT(inside, 3);
  EXPECT_LT(inside, 50);
}

}  // namespace
}  // namespace tubefoot
