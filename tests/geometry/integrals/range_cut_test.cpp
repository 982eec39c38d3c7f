// SPDX-License-Identifier: GPL-3.0-or-later
// Tests integrals over polygons by range bin. The comparisons are closed forms (physics sheet 7.4 and 7.6),
// an oracle in polar coordinates, and laws of splitting.

#include "geometry/integrals/range_cut.hpp"

#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <boost/math/quadrature/tanh_sinh.hpp>
#include <cmath>
#include <numeric>

#include "fixtures/geometry/plane_polygons.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

using test::flat_seabed;
using test::on_plane;
using test::Polygon2;
using test::random_convex;
using test::random_plane;
using test::shifted;
using Function = std::function<double(double)>;
using test::relative;

double one(double) { return 1; }
double lambert_with_absorption(double r) { return std::pow(r, -6) * std::exp(-0.2 * r); }

std::vector<double> uniform_borders(double first, double step, int count) {
  std::vector<double> borders;
  for (int k = 0; k <= count; ++k) borders.push_back(first + k * step);
  return borders;
}

std::vector<double> cut(const RadialIntegral& radial, const FacetPlane& plane, const Polygon2& polygon) {
  std::vector<double> out(radial.samples(), 0.0);
  RangeCutter(radial).add(on_plane(plane, polygon), plane, 1, out);
  return out;
}

double total(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }
double cross(glm::dvec2 a, glm::dvec2 b) { return a.x * b.y - a.y * b.x; }

/// Independent oracle: the angle over which the circle of radius rho runs inside a convex polygon. It uses
/// the intersections of the circle with all edge lines.
double angle_inside(const Polygon2& p, double rho) {
  std::vector<double> cuts{-pi, pi};
  for (std::size_t i = 0; i < p.size(); ++i) {
    const glm::dvec2 a = p[i], e = p[(i + 1) % p.size()] - a;
    const glm::dvec2 normal = glm::dvec2(e.y, -e.x) / glm::length(e);
    const double h = glm::dot(a, normal);
    if (std::abs(h) >= rho) continue;
    for (const double side : {-1.0, 1.0})
      cuts.push_back(std::remainder(std::atan2(normal.y, normal.x) + side * std::acos(h / rho), 2 * pi));
  }
  std::sort(cuts.begin(), cuts.end());
  double angle = 0;
  for (std::size_t c = 1; c < cuts.size(); ++c) {
    const double middle = (cuts[c - 1] + cuts[c]) / 2;
    const glm::dvec2 q = rho * glm::dvec2(std::cos(middle), std::sin(middle));
    bool inside = true;
    for (std::size_t i = 0; i < p.size(); ++i)
      inside = inside && cross(p[(i + 1) % p.size()] - p[i], q - p[i]) >= 0;
    if (inside) angle += cuts[c] - cuts[c - 1];
  }
  return angle;
}

/// Integrates angle_inside() over rho between the radii at which the angle has a kink.
double oracle(const Polygon2& p, double distance, double lo, double hi, const Function& g) {
  const auto radius = [distance](double r) {
    return std::sqrt(std::max((r - distance) * (r + distance), 0.0));
  };
  std::vector<double> kinks{radius(lo), radius(hi)};
  const auto add = [&](double rho) {
    if (rho > kinks[0] && rho < kinks[1]) kinks.push_back(rho);
  };
  for (std::size_t i = 0; i < p.size(); ++i) {
    const glm::dvec2 e = p[(i + 1) % p.size()] - p[i];
    add(glm::length(p[i]));
    add(std::abs(cross(p[i], e)) / glm::length(e));
  }
  std::sort(kinks.begin(), kinks.end());
  boost::math::quadrature::tanh_sinh<double> quadrature;
  double sum = 0;
  for (std::size_t k = 1; k < kinks.size(); ++k) {
    const double width = kinks[k] - kinks[k - 1];
    const auto ring = [&](double t) {
      const double rho = kinks[k - 1] + width * t;
      return g(std::hypot(rho, distance)) * rho * angle_inside(p, rho);
    };
    if (width > 0) sum += width * quadrature.integrate(ring, 0.0, 1.0, 1e-12);
  }
  return sum;
}

/// The integral of g over a whole polygon in its own coordinates: adaptive in both, triangle by triangle.
double whole(const Polygon2& p, double distance, const Function& g) {
  using boost::math::quadrature::gauss_kronrod;
  double sum = 0;
  for (std::size_t i = 2; i < p.size(); ++i) {
    const glm::dvec2 a = p[0], b = p[i - 1] - a, c = p[i] - p[i - 1];
    sum += cross(b, c) * gauss_kronrod<double, 31>::integrate(
                             [&](double s) {
                               return s * gauss_kronrod<double, 31>::integrate(
                                              [&](double t) {
                                                const glm::dvec2 q = a + s * (b + t * c);
                                                return g(std::hypot(q.x, q.y, distance));
                                              },
                                              0.0, 1.0, 6, 1e-12);
                             },
                             0.0, 1.0, 6, 1e-12);
  }
  return sum;
}

// Polygon and circle (physics sheet 7.6). The circle on the plane at distance D is the shell of range
// sqrt(D^2 + r^2).
TEST(RangeCut, PolygonAndCircleAreas) {
  const Polygon2 unit{{0, 0}, {1, 0}, {1, 1}, {0, 1}}, square{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  const Polygon2 triangle{{0, 0}, {4, 0}, {0, 3}};
  const struct {
    const char* what;
    Polygon2 polygon;
    double radius, area;
  } cases[] = {{"unit square, circle at its corner", unit, 1, pi / 4},
               {"square, circle cuts all edges", square, 1.2, 3.803644523140},
               {"square, circle at a corner", shifted(square, {-1, -1}), 1, pi / 4},
               {"square, circle at an edge's middle", shifted(square, {-1, 0}), 1, pi / 2},
               {"3-4-5 triangle, incircle", shifted(triangle, {-1, -1}), 1, pi},
               {"3-4-5 triangle, circle at the right angle", triangle, 2, pi},
               {"3-4-5 triangle, circumcircle", shifted(triangle, {-2, -1.5}), 2.5, 6}};
  for (const auto& c : cases)
    for (const double distance : {0.0, 1e-9, 0.01, 10.0}) {
      SCOPED_TRACE(testing::Message() << c.what << ", plane at " << distance);
      const RadialIntegral radial(std::vector{0.0, std::hypot(c.radius, distance), 100.0}, one);
      const std::vector<double> areas = cut(radial, flat_seabed(distance), c.polygon);
      EXPECT_NEAR(areas[0], c.area, 2e-12);
      double area_2 = 0;
      for (std::size_t i = 0; i < c.polygon.size(); ++i)
        area_2 += cross(c.polygon[i], c.polygon[(i + 1) % c.polygon.size()]);
      EXPECT_NEAR(total(areas), area_2 / 2, 1e-13);
    }
}

// Flat-bottom range bins (physics sheet 7.4): a slice of azimuth between two vertical planes.
TEST(RangeCut, RangeRingsOfAnAzimuthSlice) {
  const double h = 10, f = 1.5 * degree;
  const Polygon2 slice{{0, 0}, {60, 0}, {60 * std::cos(f), 60 * std::sin(f)}};
  const RadialIntegral far(std::vector{20.0, 20.05}, one);
  EXPECT_NEAR(cut(far, flat_seabed(h), slice)[0], 0.026212663703, 1e-12);
  const RadialIntegral first_return(std::vector{9.98, 10.03}, one);
  EXPECT_NEAR(cut(first_return, flat_seabed(h), slice)[0], 0.007865762606, 1e-12);

  const RadialIntegral rings(uniform_borders(9.9, 0.0125, 2000), one);
  const std::vector<double> areas = cut(rings, flat_seabed(h), slice);
  for (std::size_t k = 8; k < areas.size(); ++k)
    ASSERT_LT(relative(areas[k], f * (9.9 + (double(k) + 0.5) * 0.0125) * 0.0125), 1e-12) << k;
}

// Law R1.
TEST(RangeCut, EverySampleAgreesWithTheOracle) {
  const unsigned seed = 4711;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(-8, 8), logarithm(-12, 2), size(0.05, 6);
  const std::vector<double> borders{0.02, 0.5, 1, 1.5, 1.55, 3, 4.4, 6, 12};
  for (const Function& g : {Function(one), Function(lambert_with_absorption)}) {
    const RadialIntegral radial(borders, g);
    for (int i = 0; i < 40; ++i) {
      const double distance = std::exp(logarithm(random));
      const Polygon2 p = random_convex(random, {place(random), place(random)}, size(random), size(random));
      const std::vector<double> out = cut(radial, random_plane(random, distance), p);
      for (std::size_t k = 0; k < out.size(); ++k) {
        const double expected = oracle(p, distance, borders[k], borders[k + 1], g);
        ASSERT_NEAR(out[k], expected, 1e-11 * expected + 1e-13 * g(borders[k]))
            << "polygon " << i << ", sample " << k;
      }
    }
  }
}

// Law R2.
TEST(RangeCut, SumOverSamplesIsTheIntegralOverThePolygon) {
  const unsigned seed = 99;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(-10, 10), size(0.5, 5), distance(0.8, 8);
  const RadialIntegral radial(uniform_borders(0, 0.05, 800), lambert_with_absorption);
  for (int i = 0; i < 60; ++i) {
    const double d = distance(random);
    const Polygon2 p = random_convex(random, {place(random), place(random)}, size(random), size(random));
    EXPECT_LT(relative(total(cut(radial, random_plane(random, d), p)), whole(p, d, lambert_with_absorption)),
              1e-11)
        << i;
  }
}

TEST(RangeCut, FootInsideOnAnEdgeAndAtACorner) {
  const Polygon2 square{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  const RadialIntegral radial(uniform_borders(0, 0.1, 100), lambert_with_absorption);
  for (const double turn : {0.0, 0.7, 1.9})
    for (const double d : {0.3, 2.0, 5.0}) {
      // By symmetry the four quarters and the two halves are equal, with the foot point at a corner or on
      // an edge.
      const auto turned = [turn](Polygon2 p) {
        for (glm::dvec2& q : p)
          q = {q.x * std::cos(turn) - q.y * std::sin(turn), q.x * std::sin(turn) + q.y * std::cos(turn)};
        return p;
      };
      const auto all = cut(radial, flat_seabed(d), turned(square));
      const auto half = cut(radial, flat_seabed(d), turned({{-1, 0}, {1, 0}, {1, 1}, {-1, 1}}));
      const auto quarter = cut(radial, flat_seabed(d), turned({{0, 0}, {1, 0}, {1, 1}, {0, 1}}));
      EXPECT_GT(total(all), 0);
      for (std::size_t k = 0; k < all.size(); ++k) {
        ASSERT_NEAR(all[k], 2 * half[k], 1e-13 * total(all));
        ASSERT_NEAR(all[k], 4 * quarter[k], 1e-13 * total(all));
      }
    }
}

TEST(RangeCut, AnEdgeThatAllButTouchesTheFoot) {
  const RadialIntegral radial(uniform_borders(0, 0.1, 100), lambert_with_absorption);
  const auto exact = cut(radial, flat_seabed(2), {{-1, 0}, {1, 0}, {1, 1}, {-1, 1}});
  for (const double gap : {1e-300, 1e-30, 1e-18, 1e-16, 1e-12})
    for (const double side : {-1.0, 1.0}) {
      const auto near = cut(radial, flat_seabed(2), {{-1, side * gap}, {1, side * gap}, {1, 1}, {-1, 1}});
      for (std::size_t k = 0; k < exact.size(); ++k)
        ASSERT_NEAR(near[k], exact[k], 1e-13 * total(exact) + 10 * gap) << gap * side << ' ' << k;
    }
}

// Law R3.
TEST(RangeCut, AddsUpUnderSplittingOfThePolygon) {
  const unsigned seed = 31;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(-6, 6), unit(0, 1);
  const RadialIntegral radial(uniform_borders(0.5, 0.02, 700), lambert_with_absorption);
  for (int i = 0; i < 60; ++i) {
    const FacetPlane plane = random_plane(random, 0.1 + 3 * unit(random));
    const Polygon2 p = random_convex(random, {place(random), place(random)}, 3, 1.5);
    std::vector<double> parts(radial.samples(), 0.0);
    glm::dvec2 inner(0);
    for (const glm::dvec2& q : p) inner += q / double(p.size());
    RangeCutter cutter(radial);
    for (std::size_t k = 0; k < p.size(); ++k)
      cutter.add(on_plane(plane, {inner, p[k], p[(k + 1) % p.size()]}), plane, 1, parts);
    const auto one_piece = cut(radial, plane, p);
    for (std::size_t k = 0; k < parts.size(); ++k)
      ASSERT_NEAR(parts[k], one_piece[k], 1e-13 * total(one_piece));
  }
}

// Law R4.
TEST(RangeCut, AddsUpUnderSplittingOfTheSamples) {
  const unsigned seed = 32;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(-6, 6), unit(0, 1);
  // Binary fractions, so that coarse borders are fine borders. One range bin of 64 m needs many cells.
  const RadialIntegral fine(uniform_borders(0, 1.0 / 32, 2048), lambert_with_absorption);
  const RadialIntegral coarse(uniform_borders(0, 1.0 / 4, 256), lambert_with_absorption);
  const RadialIntegral single(uniform_borders(0, 64, 1), lambert_with_absorption);
  for (int i = 0; i < 60; ++i) {
    const FacetPlane plane = random_plane(random, 1e-3 + 3 * unit(random));
    const Polygon2 p = random_convex(random, {place(random), place(random)}, 3, 1.5);
    const auto f = cut(fine, plane, p), c = cut(coarse, plane, p);
    for (std::size_t k = 0; k < c.size(); ++k)
      ASSERT_NEAR(std::accumulate(&f[8 * k], &f[8 * k] + 8, 0.0), c[k], 1e-13 * total(f));
    EXPECT_LT(relative(cut(single, plane, p)[0], total(f)), 1e-12);
  }
}

// Law R5.
TEST(RangeCut, SmallPolygonsFarAwayKeepTheirDigits) {
  const unsigned seed = 5;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> angle(0, 2 * pi), grazing(0.001, 1.5);
  const RadialIntegral radial(uniform_borders(90, 3, 7), lambert_with_absorption);
  for (const double size : {1e-1, 1e-3, 1e-5, 1e-7})
    for (int i = 0; i < 30; ++i) {
      const double range = 100, a = grazing(random), turn = angle(random);
      PlanarPolygon polygon;
      polygon.distance = range * std::sin(a);
      polygon.first = range * std::cos(a) * glm::dvec2(std::cos(turn), std::sin(turn));
      const Polygon2 p = random_convex(random, {0, 0}, size, size / 3);
      for (const glm::dvec2& q : p) polygon.offsets.push_back(q - p[0]);
      // Second order about the centre: the rest is below (size / range)^3. Only the largest polygon needs
      // more.
      const double expected = [&] {
        if (size > 1e-4) {
          double sum = 0;  // many small triangles, each by the midpoints of its three edges
          for (std::size_t t = 2; t < p.size(); ++t) {
            const int n = 40;
            const glm::dvec2 o = polygon.offsets[0], u = (polygon.offsets[t - 1] - o) / double(n),
                             v = (polygon.offsets[t] - o) / double(n);
            const auto at = [&](double x, double y) {
              const glm::dvec2 q = polygon.first + o + x * u + y * v;
              return lambert_with_absorption(std::hypot(q.x, q.y, polygon.distance));
            };
            for (int x = 0; x < n; ++x)
              for (int y = 0; x + y < n; ++y) {
                sum += cross(u, v) / 6 * (at(x + .5, y) + at(x, y + .5) + at(x + .5, y + .5));
                if (x + y + 1 < n)
                  sum += cross(u, v) / 6 * (at(x + 1, y + .5) + at(x + .5, y + 1) + at(x + .5, y + .5));
              }
          }
          return sum;
        }
        const glm::dvec2 q = polygon.first + centroid_offset(polygon);
        return area(polygon) * lambert_with_absorption(std::hypot(q.x, q.y, polygon.distance));
      }();
      std::vector<double> out(radial.samples(), 0.0);
      RangeCutter(radial).add(polygon, 1, out);
      EXPECT_LT(relative(total(out), expected), 1e-11) << "size " << size << ", polygon " << i;
    }
}

TEST(RangeCut, GrazingAndNadir) {
  const RadialIntegral radial(uniform_borders(1, 0.25, 100), lambert_with_absorption);
  for (const double d : {1e-12, 1e-6, 1e-3}) {
    const Polygon2 p{{5, -1}, {9, -1}, {9, 1}, {5, 1}};
    EXPECT_LT(relative(total(cut(radial, flat_seabed(d), p)), whole(p, d, lambert_with_absorption)), 1e-11)
        << d;
  }
  for (const double size : {1e-6, 1e-3, 1e-1}) {  // straight below, where range is stationary
    const Polygon2 p{{-size, -size}, {size, -size}, {size, size}, {-size, size}};
    EXPECT_LT(relative(total(cut(radial, flat_seabed(10), p)), whole(p, 10, lambert_with_absorption)), 1e-11)
        << size;
  }
}

TEST(RangeCut, PolygonsOutsideAndPartlyOutsideOfTheSamples) {
  const Polygon2 p{{3, -1}, {9, -1}, {9, 1}, {3, 1}};
  const FacetPlane plane = flat_seabed(4);  // ranges 5 to 9.9
  const auto none = [&](std::vector<double> borders) {
    return total(cut(RadialIntegral(borders, one), plane, p));
  };
  EXPECT_EQ(none({1, 2, 4.9}), 0);
  EXPECT_EQ(none({9.91, 12}), 0);
  EXPECT_NEAR(none({1, 20}), 12, 1e-13);
  for (const double border : {5.5, 6.0, 7.0, 9.0, 9.8})
    EXPECT_NEAR(none({1, border}) + none({border, 20}), 12, 1e-13) << border;
}

TEST(RangeCut, PolygonThatBeginsAtTheLastBorderTouchesNoSample) {
  const RadialIntegral radial(std::vector{1.0, 3.0, 5.0}, one);
  std::vector<double> out(radial.samples(), 0.0);
  PlanarPolygon polygon;
  polygon.assign(on_plane(flat_seabed(4), {{3, 0}, {9, 0}, {9, 1}, {3, 1}}), flat_seabed(4),
                 PlaneFrame(flat_seabed(4)));
  ASSERT_EQ(nearest_point(polygon).range, 5);
  const SampleSpan touched = RangeCutter(radial).add(polygon, 1, out);
  EXPECT_EQ(touched.first, 0u);
  EXPECT_EQ(touched.end, 0u);
  EXPECT_EQ(total(out), 0);
}

TEST(RangeCut, CornersWithinRoundingOfABorder) {
  const unsigned seed = 12;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(-6, 6);
  for (int i = 0; i < 300; ++i) {
    const FacetPlane plane = random_plane(random, 1);
    PlanarPolygon polygon;
    polygon.assign(on_plane(plane, random_convex(random, {place(random), place(random)}, 2, 1)), plane,
                   PlaneFrame(plane));
    const double near = nearest_point(polygon).range, far = farthest_range(polygon);
    for (const double toward : {0.0, 100.0})
      for (const int ulps : {0, 1, 2}) {
        double a = near, b = far;
        for (int u = 0; u < ulps; ++u) {
          a = std::nextafter(a, toward);
          b = std::nextafter(b, toward);
        }
        const RadialIntegral radial(std::vector{0.5, a, (a + b) / 2, b, 50.0}, one);
        std::vector<double> out(4, 0.0);
        RangeCutter(radial).add(polygon, 1, out);
        ASSERT_NEAR(out[0], 0, 1e-13) << i;
        ASSERT_NEAR(out[1] + out[2], area(polygon), 1e-12) << i;
        ASSERT_NEAR(out[3], 0, 1e-13) << i;
      }
  }
}

TEST(RangeCut, DegeneratePolygonsAddNothing) {
  const RadialIntegral radial(uniform_borders(1, 0.25, 100), one);
  EXPECT_EQ(total(cut(radial, flat_seabed(3), {})), 0);
  EXPECT_EQ(total(cut(radial, flat_seabed(3), {{1, 1}})), 0);
  EXPECT_EQ(total(cut(radial, flat_seabed(3), {{1, 1}, {2, 2}})), 0);
  EXPECT_EQ(total(cut(radial, flat_seabed(3), {{1, 1}, {1, 1}, {1, 1}})), 0);
  EXPECT_NEAR(total(cut(radial, flat_seabed(3), {{1, 1}, {2, 2}, {3, 3}})), 0, 1e-14);
}

TEST(RangeCut, TheOtherTurnIsNegative) {
  const RadialIntegral radial(uniform_borders(1, 0.25, 100), one);
  EXPECT_NEAR(total(cut(radial, flat_seabed(3), {{1, 1}, {1, 2}, {2, 1}})), -0.5, 1e-14);
}

TEST(RadialIntegral, ShortIntervalsKeepTheirDigits) {
  const RadialIntegral radial(uniform_borders(10, 1, 10), lambert_with_absorption);
  const auto& cell = radial.cells()[radial.cell_at(14.3)];
  for (const double length : {1e-3, 1e-6, 1e-9, 1e-12}) {
    const double middle = 14.3 + length / 2;
    const double curved = 1 + length * length;  // generous second-order rest
    EXPECT_LT(relative(RadialIntegral::within(cell, 14.3, length),
                       lambert_with_absorption(middle) * middle * length),
              1e-13 + (curved - 1));
  }
}

TEST(RadialIntegral, FindsTheCellAmongSamplesOfUnequalWidths) {
  const std::vector<double> wide_first{1, 9, 9.1, 9.2, 9.3, 9.4, 9.5, 10},
      wide_last{1, 1.1, 1.2, 1.3, 1.4, 10};
  for (const auto& borders : {wide_first, wide_last}) {
    const RadialIntegral radial(borders, one);
    for (double range = 1; range < 10; range += 0.01) {
      const RadialIntegral::Cell& cell = radial.cells()[radial.cell_at(range)];
      EXPECT_LE(cell.lo, range);
      EXPECT_GT(cell.hi, range);
    }
    for (std::size_t k = 0; k + 1 < borders.size(); ++k)
      EXPECT_EQ(radial.cells()[radial.cell_at(borders[k])].sample, k);
  }
}

TEST(RadialIntegral, RefusesBadBordersAndFunctions) {
  const double nan = std::nan("");
  EXPECT_THROW(RadialIntegral(std::vector<double>{}, one), std::invalid_argument);
  EXPECT_THROW(RadialIntegral(std::vector{1.0}, one), std::invalid_argument);
  EXPECT_THROW(RadialIntegral(std::vector{1.0, 1.0}, one), std::invalid_argument);
  EXPECT_THROW(RadialIntegral(std::vector{2.0, 1.0}, one), std::invalid_argument);
  EXPECT_THROW(RadialIntegral(std::vector{-1.0, 1.0}, one), std::invalid_argument);
  EXPECT_THROW(RadialIntegral(std::vector{1.0, nan}, one), std::invalid_argument);
  EXPECT_THROW(RadialIntegral(std::vector{1.0, HUGE_VAL}, one), std::invalid_argument);
  EXPECT_THROW(RadialIntegral(std::vector{1.0, 2.0}, [nan](double) { return nan; }), std::invalid_argument);
  EXPECT_THROW(RadialIntegral(std::vector{1.0, 2.0}, [](double r) { return r < 1.4 ? 0.0 : 1.0; }),
               std::invalid_argument);
}

}  // namespace
}  // namespace tubefoot
