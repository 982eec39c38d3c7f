// SPDX-License-Identifier: GPL-3.0-or-later
// Tests waves over polygons by path length, in ball arithmetic. One frequency agrees with
// certified_waves.hpp for any division into path intervals. Pulses with flanks agree with sums over edges
// without path intervals.
#include "geometry/integrals/certified_path_wave.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <glm/common.hpp>
#include <random>

#include "fixtures/geometry/balls.hpp"
#include "fixtures/geometry/plane_polygons.hpp"
#include "geometry/integrals/certified_waves.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

using test::Polygon2;
using Complex = std::complex<double>;
using test::outside;
using test::points;
using test::radius;

Complex middle(const ComplexBall& ball) { return {ball.real().middle(), ball.imaginary().middle()}; }

/// Returns e^{ikP} over all paths, cut at `borders`.
PathWave one_frequency(double k, const std::vector<double>& borders) {
  PathWave wave;
  wave.origin = Ball(borders.front());
  wave.largest = 1;
  wave.steepest = k;
  for (std::size_t i = 0; i + 1 < borders.size(); ++i)
    wave.stretches.push_back(
        {Ball(borders[i]),
         Ball(borders[i + 1]),
         {{certified_phasor(Ball(k) * wave.origin), ComplexBall(Ball(0.0), Ball(k)), ComplexBall(0.0)}}});
  return wave;
}

struct CertifiedEnds {
  Ball height;
  ApexOverPlane rx;
  double h, x, y, s;  ///< the same in doubles
};
CertifiedEnds ends(double height, double x, double y, double rx_height) {
  return {Ball(height), {Ball(rx_height), Ball(x), Ball(y)}, height, x, y, rx_height};
}

TEST(CertifiedPathWave, OneFrequencyIsThatOfTheEdgeForm) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> place(-0.6, 0.6), height(0.5, 4);
  for (int n = 0; n < 24; ++n) {
    const Polygon2 polygon = test::random_convex(random, {place(random), place(random)}, 0.4, 0.4 / 2);
    const CertifiedEnds e = n % 3 == 0 ? ends(1.7, 0, 0, 1.7)
                                       : ends(height(random), place(random), place(random), height(random));
    const double k = 2 * pi * 30e3 / 1500;
    const auto sure = certified_edge_form(points(polygon), e.height, e.rx, Ball(k), 1e-15);
    ASSERT_TRUE(sure);
    CertifiedPathEdges edges(points(polygon), e.height, e.rx);
    // Borders that edges meet, and borders about the shortest path.
    const double least = edges.shortest_path(), most = edges.longest_path();
    for (const std::vector<double>& borders :
         {std::vector<double>{0, 100},
          {0, least + 0.3 * (most - least), least + 0.6 * (most - least), 100}}) {
      const ComplexBall sum = edges.integral(one_frequency(k, borders), 1e-15);
      ASSERT_LT(std::abs(middle(sum) - middle(*sure)), 4 * (radius(sum) + radius(*sure)) + 1e-16) << n;
      ASSERT_LT(radius(sum), 1e-11) << n << " " << borders.size();
    }
  }
}

// This includes polygons that do not contain the point of the shortest path. The nearest end of an edge
// then begins a short interval.
TEST(CertifiedPathWave, NoPathIsShorterOrLongerThanThoseTold) {
  std::mt19937_64 random(12);
  std::uniform_real_distribution<double> place(-3, 3), height(0.1, 2);
  const auto hold = [](const Polygon2& polygon, const CertifiedEnds& e) {
    const CertifiedPathEdges edges(points(polygon), e.height, e.rx);
    const auto path = [&](glm::dvec2 p) {
      return std::hypot(p.x, p.y, e.h) + std::hypot(p.x - e.x, p.y - e.y, e.s);
    };
    for (std::size_t k = 0; k < polygon.size(); ++k)
      for (int i = 0; i <= 200; ++i)
        for (const double inwards : {0.0, 0.3}) {
          const glm::dvec2 on = glm::mix(polygon[k], polygon[(k + 1) % polygon.size()], i / 200.0),
                           p = glm::mix(on, polygon[0], inwards);
          ASSERT_GE(path(p), edges.shortest_path() * (1 - 1e-14));
          ASSERT_LE(path(p), edges.longest_path() * (1 + 1e-14));
        }
  };
  hold({{-3, 0.05}, {1.1, 0.05}, {1.1, 0.9}, {0.5, 1.95}, {-1.5, 2.35}}, ends(1, 0, 0, 1));
  for (int n = 0; n < 300; ++n) {
    Polygon2 polygon = test::random_convex(random, {place(random), place(random)}, 2, 1);
    if (n % 2 == 1) std::reverse(polygon.begin(), polygon.end());
    hold(polygon,
         n % 3 == 0 ? ends(1, 0, 0, 1) : ends(height(random), place(random), place(random), height(random)));
  }
}

// Edges and corners lie at the point of the shortest path, either whole or at the end of a path interval.
TEST(CertifiedPathWave, EdgesThroughTheShortestPathAreLikeOthers) {
  const Polygon2 whole{{-0.5, -0.4}, {0.5, -0.4}, {0.5, 0.4}, {-0.5, 0.4}};
  const double k = 2 * pi * 20e3 / 1500;
  for (const CertifiedEnds& e : {ends(1.5, 0, 0, 1.5), ends(1.5, 0.25, 0, 1.5)}) {
    const double x = e.x / 2;
    const auto sure = certified_edge_form(points(whole), e.height, e.rx, Ball(k), 1e-15);
    ASSERT_TRUE(sure);
    const double shortest = std::hypot(3.0, e.x);
    for (const std::vector<double>& borders :
         {std::vector<double>{0, 100}, {0, shortest + 1e-3, 100}, {0, shortest, 100}}) {
      ComplexBall sum(0.0);
      for (const Polygon2& part : {Polygon2{{-0.5, -0.4}, {x, -0.4}, {x, 0}, {-0.5, 0}},
                                   Polygon2{{x, -0.4}, {0.5, -0.4}, {0.5, 0}, {x, 0}},
                                   Polygon2{{-0.5, 0}, {0.5, 0}, {0.5, 0.4}, {-0.5, 0.4}}}) {
        CertifiedPathEdges edges(points(part), e.height, e.rx);
        sum += edges.integral(one_frequency(k, borders), 1e-14);
      }
      EXPECT_LT(outside(sum, middle(*sure)), 1e-16);
      EXPECT_LT(radius(sum), borders.size() == 2 ? 1e-12 : 1e-5);
    }
  }
}

/// A Hann window of one frequency: paths from `begin` on.
struct Pulse {
  double begin, length, k;
  Complex at(double path) const {
    const double x = (path - begin) / length;
    if (x < 0 || x > 1) return 0;
    return (1 - std::cos(2 * pi * x)) / 2 * std::polar(1.0, k * path);
  }
  PathWave wave() const {
    PathWave wave;
    wave.origin = Ball(begin);
    wave.largest = 1;
    wave.steepest = k + pi / length;
    const ComplexBall start = certified_phasor(Ball(k) * Ball(begin)), none(0.0);
    const Ball turn = Ball(2.0) * Ball::pi() / Ball(length);
    wave.stretches.push_back({Ball(begin),
                              Ball(begin) + Ball(length),
                              {{start * ComplexBall(0.5), ComplexBall(Ball(0.0), Ball(k)), none},
                               {start * ComplexBall(-0.25), ComplexBall(Ball(0.0), Ball(k) + turn), none},
                               {start * ComplexBall(-0.25), ComplexBall(Ball(0.0), Ball(k) - turn), none}}});
    return wave;
  }
};

/// Computes (2) of docs/notes/smooth-surfaces.md by the midpoints of many parts, with one extrapolation.
Complex by_sums(const Polygon2& polygon, const CertifiedEnds& e, const Pulse& pulse) {
  const double heights = e.h + e.s, d = std::hypot(heights, e.x, e.y), c_x = e.x * e.h / heights,
               c_y = e.y * e.h / heights;
  const auto sum_of = [&](int parts) {
    Complex sum = 0;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const glm::dvec2 a = polygon[i], step = polygon[(i + 1) % polygon.size()] - a;
      for (int n = 0; n < parts; ++n) {
        const glm::dvec2 q = a + (n + 0.5) / parts * step, from(q.x - c_x, q.y - c_y);
        const double r = std::hypot(q.x, q.y, e.h), s = std::hypot(q.x - e.x, q.y - e.y, e.s),
                     along = (from.x * e.x + from.y * e.y) / d,
                     square = from.x * from.x + from.y * from.y - along * along,
                     turn = heights / d * (from.x * step.y - from.y * step.x) / square / parts,
                     w = (d * d - (r - s) * (r - s)) / (2 * d * r * s);
        sum += turn / (4 * pi) * (2 / d * pulse.at(d) - w * pulse.at(r + s));
      }
    }
    return sum;
  };
  return (4.0 * sum_of(40000) - sum_of(20000)) / 3.0;
}

TEST(CertifiedPathWave, PulsesWithFlanksHoldSumsOverTheEdges) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> place(-0.5, 0.5), height(0.8, 3), share(-0.3, 1);
  for (int n = 0; n < 40; ++n) {
    const Polygon2 polygon = test::random_convex(random, {place(random), place(random)}, 0.5, 0.5 / 2);
    const CertifiedEnds e = n % 2 == 0 ? ends(1.5, 0, 0, 1.5)
                                       : ends(height(random), place(random), place(random), height(random));
    CertifiedPathEdges edges(points(polygon), e.height, e.rx);
    const double extent = edges.longest_path() - edges.shortest_path();
    const Pulse pulse{edges.shortest_path() + share(random) * extent, 0.3, 2 * pi * 20e3 / 1500};
    const ComplexBall sum = edges.integral(pulse.wave(), 1e-13);
    ASSERT_LT(outside(sum, by_sums(polygon, e, pulse)), 2e-8) << n;
    ASSERT_LT(radius(sum), 1e-11) << n;
  }
}

}  // namespace
}  // namespace tubefoot
