// SPDX-License-Identifier: GPL-3.0-or-later
// Tests waves over planes as integrals over polygon edges. The comparisons are values of the signals sheet,
// closed forms, laws, and independent surface quadrature.
#include "geometry/integrals/edge_form.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <random>

#include "fixtures/geometry/plane_polygons.hpp"
#include "geometry/integrals/gauss_rules.hpp"
#include "geometry/integrals/polygon_transform.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

using test::planar;
using test::Polygon2;
using Complex = std::complex<double>;
using test::k_100khz;

struct Ends {
  double tx_height, rx_height;
  glm::dvec2 rx_foot{0};
};

Complex edges(const Polygon2& corners, const Ends& ends, double k) {
  Complex sum = 0;
  EdgeForm form([k](double path, std::span<Complex> values) { values[0] = phasor(k * path); }, 1, k);
  form.add(planar(corners, ends.tx_height), {ends.rx_height, ends.rx_foot}, std::span(&sum, 1));
  return sum;
}

/// The surface integral itself: (1/4 pi) d/dn of e^{ik(r+s)}/(rs), over a fan of triangles that are divided
/// until they are small.
Complex by_surface(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c, const Ends& ends, double k, double size) {
  const double longest = std::max({glm::length(b - a), glm::length(c - b), glm::length(a - c)});
  if (longest > size) {
    const glm::dvec2 ab = (a + b) / 2.0, bc = (b + c) / 2.0, ca = (c + a) / 2.0;
    return by_surface(a, ab, ca, ends, k, size) + by_surface(ab, b, bc, ends, k, size) +
           by_surface(ca, bc, c, ends, k, size) + by_surface(ab, bc, ca, ends, k, size);
  }
  const GaussRule& rule = gauss_rule(12);
  const double twice = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  Complex sum = 0;
  for (std::size_t i = 0; i < 12; ++i)
    for (std::size_t j = 0; j < 12; ++j) {
      const double s = (1 + rule.node[i]) / 2, t = (1 + rule.node[j]) / 2;
      const glm::dvec2 p = a + s * (b - a) + s * t * (c - b), q = p - ends.rx_foot;
      const double h = ends.tx_height, g = ends.rx_height, r = std::sqrt(h * h + glm::dot(p, p)),
                   v = std::sqrt(g * g + glm::dot(q, q));
      const Complex ik(0, k), slope = -(h / r) * (ik - 1 / r) - (g / v) * (ik - 1 / v);
      sum += rule.weight[i] * rule.weight[j] / 4 * s * twice * slope * phasor(k * (r + v)) / (r * v);
    }
  return sum / (4 * pi);
}
Complex by_surface(const Polygon2& corners, const Ends& ends, double k, double size) {
  Complex sum = 0;
  for (std::size_t i = 2; i < corners.size(); ++i)
    sum += by_surface(corners[0], corners[i - 1], corners[i], ends, k, size);
  return sum;
}

Polygon2 square(double side) {
  const double a = side / 2;
  return {{-a, -a}, {a, -a}, {a, a}, {-a, a}};
}

// Values of the signals sheet, to the printed digits.
TEST(EdgeForm, HasTheSheetsDigits) {
  EXPECT_LT(std::abs(edges(square(0.2), {1, 1}, k_100khz) - Complex(-0.4338993602338, 0.2430891220881)),
            1e-13);
  EXPECT_LT(std::abs(edges({{-.3, -.2}, {.4, -.1}, {.1, .5}}, {2, 2}, k_100khz) -
                     Complex(-0.09601684309, -0.18073857278)),
            1e-11);
  // S (-.2, .05, 1), E (.3, -.1, .8). The polygon is counter-clockwise about the normal as seen from above.
  // A piece has the opposite orientation, and so has the frame.
  Polygon2 seen;
  for (const glm::dvec2& p : square(0.2)) seen.push_back(p - glm::dvec2(-.2, .05));
  EXPECT_LT(std::abs(edges(seen, {1, .8, {.5, -.15}}, k_100khz) - Complex(0.318785111189, -0.343830832103)),
            1e-12);
}

// The pulse of the sheet, sigma 10 us: its peak and 13 us later.
TEST(EdgeForm, PulseHasTheSheetsDigits) {
  const double sigma = 10e-6, omega = 2 * pi * 100e3, c = 1500, at = 2 / c;
  const std::array<double, 2> times{at, at + 13e-6};
  std::array<Complex, 2> sum{};
  EdgeForm form(
      [&](double path, std::span<Complex> values) {
        for (std::size_t i = 0; i < 2; ++i) {
          const double t = times[i] - path / c;
          values[i] = std::exp(-t * t / (2 * sigma * sigma)) * phasor(-omega * t);
        }
      },
      2, (omega + 8 / sigma) / c);
  form.add(planar(square(0.2), 1), sum);
  EXPECT_LT(std::abs(sum[0] - Complex(0.4663184959, 0.2106363500)), 1e-10);
  EXPECT_LT(std::abs(sum[1] - Complex(0.1552026905, -0.1955910541)), 1e-10);
}

// On the axis of a disc its rim has one range. A polygon of n corners differs from the disc by about n^-2.
TEST(EdgeForm, DiscHasItsClosedForm) {
  const double h = 1, a = 0.1;
  const auto of = [&](int corners) {
    Polygon2 disc;
    for (int i = 0; i < corners; ++i)
      disc.push_back(a * glm::dvec2(std::cos(2 * pi * i / corners), std::sin(2 * pi * i / corners)));
    return edges(disc, {h, h}, k_100khz);
  };
  const double far = std::sqrt(h * h + a * a);
  const Complex disc = phasor(2 * k_100khz * h) / (2 * h) - h / (2 * far * far) * phasor(2 * k_100khz * far);
  EXPECT_NEAR(std::abs(of(200) - disc) / std::abs(of(400) - disc), 4, 1e-3);
  // Richardson extrapolation removes this error, and the next step removes n^-4.
  const Complex once = (4.0 * of(800) - of(400)) / 3.0, twice = (4.0 * of(1600) - of(800)) / 3.0;
  EXPECT_LT(std::abs((16.0 * twice - once) / 15.0 - disc), 1e-12);
}

// Law Q4: with a loss, the edges of a very large polygon have no influence.
TEST(EdgeForm, InfinitePlaneIsItsImage) {
  const Ends ends{2, 0.7, {3, -1}};
  const double loss = 1, shortest = std::sqrt(2.7 * 2.7 + 10);
  for (const glm::dvec2 moved : {glm::dvec2(0), glm::dvec2(9, 3), ends.rx_foot * (2 / 2.7)}) {
    Complex sum = 0;
    EdgeForm form(
        [&](double path, std::span<Complex> values) {
          values[0] = phasor(20 * path) * std::exp(-loss * (path - shortest));
        },
        1, 22);
    form.add(planar(test::shifted(square(100), moved), 2), {0.7, ends.rx_foot}, std::span(&sum, 1));
    EXPECT_LT(std::abs(sum - phasor(20 * shortest) / shortest), 1e-14);
  }
}

TEST(EdgeForm, EqualsTheSurfaceIntegral) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int n = 0; n < 40; ++n) {
    const Ends ends{0.2 + unit(random), 0.2 + unit(random), {unit(random) - .5, unit(random) - .5}};
    const double k = 200 * unit(random);
    const Polygon2 polygon = test::random_convex(random, {2 * unit(random) - 1, 2 * unit(random) - 1}, .4,
                                                 .05 + .3 * unit(random));
    const Complex surface = by_surface(polygon, ends, k, 0.025);
    EXPECT_LT(std::abs(edges(polygon, ends, k) - surface), 1e-12) << n;
    // Law Q5: the value is the same from the other end.
    const Polygon2 other = test::shifted(polygon, -ends.rx_foot);
    EXPECT_LT(std::abs(edges(other, {ends.rx_height, ends.tx_height, -ends.rx_foot}, k) - surface), 1e-12);
  }
}

// Edges through the foot point or at less than a wavelength from it, and corners on it.
TEST(EdgeForm, IsNotSingularWhereTheEdgeMeetsTheShortestPath) {
  for (const double beside : {0.0, 1e-300, 1e-14, 1e-9, 1e-5, 1e-3})
    for (const glm::dvec2 foot : {glm::dvec2(0), glm::dvec2(.3, .1)}) {
      const Ends ends{0.5, 0.6, foot};
      const glm::dvec2 c = foot * (0.5 / 1.1);
      const Polygon2 beyond{c + glm::dvec2(beside, -.1), c + glm::dvec2(.2, -.1), c + glm::dvec2(.2, .1),
                            c + glm::dvec2(beside, .1)};
      const Polygon2 corner{c + glm::dvec2(beside, beside), c + glm::dvec2(.2, beside),
                            c + glm::dvec2(.2, .1)};
      EXPECT_LT(std::abs(edges(beyond, ends, 100) - by_surface(beyond, ends, 100, 0.05)), 1e-13) << beside;
      EXPECT_LT(std::abs(edges(corner, ends, 100) - by_surface(corner, ends, 100, 0.05)), 1e-13) << beside;
    }
}

// The parts of a polygon add up, for any cuts.
TEST(EdgeForm, PolygonsAddUp) {
  std::mt19937_64 random(9);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int n = 0; n < 200; ++n) {
    const Ends ends{1, 2, {unit(random), unit(random)}};
    const glm::dvec2 a{unit(random), unit(random)}, b = a + glm::dvec2(.5, .1 * unit(random)),
                                                    c = b + glm::dvec2(-.2, .4), d = a + glm::dvec2(-.1, .3);
    const glm::dvec2 inner = (a + b + c) / 3.0;
    const Complex whole = edges({a, b, c, d}, ends, k_100khz);
    const Complex parts = edges({a, b, inner}, ends, k_100khz) + edges({b, c, inner}, ends, k_100khz) +
                          edges({c, d, inner}, ends, k_100khz) + edges({d, a, inner}, ends, k_100khz);
    EXPECT_LT(std::abs(whole - parts), 1e-12);
  }
}

// Law Q3, and the arc form of the amplitude.
TEST(ArcAngle, GivesAreasAndAmplitudes) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int n = 0; n < 20; ++n) {
    const Polygon2 polygon = test::random_convex(random, {unit(random) - .5, unit(random) - .5}, .6, .4);
    const double h = 0.3 + unit(random);
    const PlanarPolygon p = planar(polygon, h);
    // Between ranges of corners and of nearest points the angle is smooth, except for square roots at the
    // ends. The substitution r = middle + half sin(pi x / 2) removes these roots.
    std::vector<double> borders{h};
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const glm::dvec2 a = polygon[i], e = polygon[(i + 1) % polygon.size()] - a;
      const glm::dvec2 nearest = a - glm::dot(a, e) / glm::dot(e, e) * e;
      borders.push_back(std::sqrt(h * h + glm::dot(a, a)));
      borders.push_back(std::sqrt(h * h + glm::dot(nearest, nearest)));
    }
    std::sort(borders.begin(), borders.end());
    const double k = 30;
    double sum = 0;
    Complex amplitude = 0;
    const GaussRule& rule = gauss_rule(24);
    for (std::size_t i = 0; i + 1 < borders.size(); ++i)
      for (int part = 0; part < 8; ++part)
        for (std::size_t j = 0; j < 24; ++j) {
          const double x = (part + (1 + rule.node[j]) / 2) / 4 - 1, half = (borders[i + 1] - borders[i]) / 2;
          const double r = borders[i] + half * (1 + std::sin(pi * x / 2));
          const double step = rule.weight[j] / 8 * half * pi / 2 * std::cos(pi * x / 2);
          const double angle = arc_angle(p, r);
          sum += step * angle * r;
          amplitude += step * h / (2 * pi) * angle * (1 / r - Complex(0, k)) * phasor(2 * k * r) / (r * r);
        }
    EXPECT_NEAR(sum, area(p), 1e-9);
    EXPECT_LT(std::abs(amplitude - edges(polygon, {h, h}, k)), 1e-8);
  }
  EXPECT_EQ(arc_angle(planar(square(2), 1), 1.2), 2 * pi);
  EXPECT_EQ(arc_angle(planar(square(2), 1), 0.9), 0);
  EXPECT_EQ(arc_angle(planar(square(2), 1), 9), 0);
}

}  // namespace
}  // namespace tubefoot
