// SPDX-License-Identifier: GPL-3.0-or-later
// Tests intervals of long doubles, and enclosures of pieces in such intervals. The comparison is ball
// arithmetic of 128 bits.
#include "geometry/integrals/interval_polygon.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "fixtures/geometry/metre_meshes.hpp"
#include "geometry/integrals/certified_polygon.hpp"
#include "geometry/search/scene_tree.hpp"

namespace tubefoot {
namespace {

bool holds(const FineInterval& interval, const Ball& ball) {
  return interval.lo <= ball.fine_lo() && ball.fine_hi() <= interval.hi;
}
bool holds(const RangeEnclosure& range, const RangeEnclosure& truth) {
  return range.lo <= truth.lo && truth.hi <= range.hi;
}
bool holds(const Interval& interval, const Ball& ball) {
  return interval.lo <= ball.lo() && ball.hi() <= interval.hi;
}
bool is_narrow(const FineInterval& interval, long double least) {
  return interval.hi - interval.lo <= std::max(std::abs(interval.hi) * 1e-17L, least);
}

TEST(FineInterval, HoldsSumsProductsQuotientsAndRoots) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> digits(-2, 2), decades(-30, 30);
  // Ends with more digits than a double.
  const auto any = [&] {
    const long double head = digits(random) * std::pow(10, decades(random));
    return head + head * static_cast<long double>(digits(random)) * 0x1p-55L;
  };
  for (int trial = 0; trial < 2000; ++trial) {
    const long double x = any(), y = trial % 3 == 0 ? x * (1 + 1e-15L) : any();
    const FineInterval a(x), b(y);
    const Ball p(x), q(y);
    EXPECT_TRUE(holds(a + b, p + q));
    EXPECT_TRUE(holds(a - b, p - q));
    EXPECT_TRUE(holds(a * b, p * q));
    EXPECT_TRUE(holds(a / b, p / q));
    EXPECT_TRUE(holds(squared(a), squared(p)));
    EXPECT_TRUE(holds(root(squared(a)), root(squared(p))));
    EXPECT_TRUE(holds(a.in_doubles(), p));
    // The intervals run from end to end, with any signs.
    const FineInterval wide(std::min(x, y), std::max(x, y)), other(-std::abs(x), std::abs(y));
    for (const auto& [u, s] : {std::pair(x, p), std::pair(y, q)})
      for (const auto& [v, t] : {std::pair(-std::abs(x), Ball(-std::abs(x))), std::pair(0.0L, Ball())}) {
        EXPECT_TRUE(holds(wide * other, s * t)) << double(u) << ' ' << double(v);
        EXPECT_TRUE(holds(wide - other, s - t)) << double(u) << ' ' << double(v);
      }
  }
  EXPECT_FALSE(std::isfinite(double((FineInterval(1.0) / FineInterval(-1.0L, 1.0L)).hi)));
}

TEST(FineInterval, HoldsWholeNumbersOfAnySize) {
  std::mt19937_64 random(6);
  for (int trial = 0; trial < 500; ++trial) {
    const auto a = std::int64_t(random()) >> (trial % 60), b = std::int64_t(random()) >> 2,
               c = std::int64_t(random()) >> (2 + trial % 50);
    const Int128 two = Int128(b) * c;
    const auto ball = [](std::int64_t x) {
      Ball result;
      arb_set_si(result.get(), slong(x));
      return result;
    };
    EXPECT_TRUE(holds(FineInterval::of(a), ball(a)));
    EXPECT_TRUE(holds(FineInterval::of(two), ball(b) * ball(c)));
    const std::int64_t third = c >> 1;
    const Int192 three = multiply(two, third);
    Ball exact = ball(b) * ball(c);
    arb_mul_si(exact.get(), exact.get(), slong(third), 400);
    EXPECT_TRUE(holds(FineInterval::of(three), exact)) << trial;
    EXPECT_TRUE(is_narrow(FineInterval::of(three), 0));
  }
}

TEST(IntervalPolygon, HoldsBallsOfPiecesOfEveryKindOfCorner) {
  const WorldGrid grid(20, glm::dvec3(0));
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> side(-1, 1), decades(-2.5, 0.3);
  const auto somewhere = [&] { return glm::dvec3(side(random), side(random), side(random)); };
  std::vector<std::array<glm::dvec3, 3>> facets;
  for (int k = 0; k < 300; ++k) {
    const glm::dvec3 place = glm::dvec3(0, 0, -6) + glm::dvec3(4, 4, 2.5) * somewhere();
    const double size = std::pow(10, decades(random));
    facets.push_back({place + size * somewhere(), place + size * somewhere(), place + size * somewhere()});
  }
  facets.push_back({glm::dvec3(-50, -50, -9), {50, -50, -9}, {0, 70, -9}});
  const FacetMesh mesh = test::mesh_of(facets, grid);
  const SceneTree tree(mesh);
  TubeSet set;
  set.apex = grid.snap(glm::dvec3(0));
  set.reach = 200 / grid.unit_m();
  for (int k = -4; k < 4; ++k)
    test::add_pyramid(set, {glm::dvec3(0.2 * k, -0.8, -1),
                            {0.2 * k + 0.2, -0.8, -1},
                            {0.2 * k + 0.2, 0.9, -1},
                            {0.2 * k, 0.9, -1}});
  int of_points = 0, of_planes = 0, of_depths = 0, pieces = 0;
  VisibilityScratch scratch;
  TubeVisibility seen;
  IntervalPolygon fast;
  for (std::uint32_t tube = 0; tube < set.tubes.size(); ++tube) {
    see(mesh, tree, set, tube, VisibilityOptions{}, scratch, seen);
    const NameContext context{mesh, set.apex, seen.rays};
    for (const NamedPiece& piece : seen.pieces) {
      for (std::size_t k = piece.first; k < piece.first + piece.count; ++k) {
        const CornerName& corner = seen.corners[k];
        const bool depth = corner.point == no_point && (corner.p.depth || corner.q.depth);
        ++(corner.point != no_point ? of_points : depth ? of_depths : of_planes);
      }
      SCOPED_TRACE(testing::Message() << "tube " << tube << ", facet " << piece.facet);
      if (!enclose_in_intervals(context, seen.corners, piece, grid.unit_m(), fast)) continue;
      ++pieces;
      const CertifiedPolygon sure = certified_polygon(context, seen.corners, piece, grid.unit_m());
      EXPECT_TRUE(holds(fast.distance, sure.distance));
      EXPECT_TRUE(is_narrow(fast.distance, 0));
      EXPECT_TRUE(holds(fast.perimeter, sure.perimeter));
      ASSERT_EQ(fast.edges.size(), sure.edges.size());
      for (std::size_t e = 0; e < fast.edges.size(); ++e) {
        EXPECT_TRUE(holds(fast.points[e].x, sure.points[e].x));
        EXPECT_TRUE(holds(fast.points[e].y, sure.points[e].y));
        EXPECT_TRUE(is_narrow(fast.points[e].x, 1e-16L));
        EXPECT_TRUE(holds(fast.edges[e].height, sure.edges[e].height));
        EXPECT_TRUE(holds(fast.edges[e].nearest2, sure.edges[e].nearest2));
        const double turns = std::round((fast.edges[e].angle.middle() - sure.edges[e].angle.middle()) /
                                        (2 * std::numbers::pi));
        EXPECT_TRUE(holds(fast.edges[e].angle, sure.edges[e].angle + Ball(2 * turns) * Ball::pi()));
        EXPECT_TRUE(holds(fast.ranges[e].from, sure.ranges[e].from));
        EXPECT_TRUE(holds(fast.ranges[e].to, sure.ranges[e].to));
        EXPECT_TRUE(holds(fast.ranges[e].nearest, sure.ranges[e].nearest));
        for (const auto& [own, truth] : {std::pair(fast.ranges[e].side_from, sure.ranges[e].side_from),
                                         std::pair(fast.ranges[e].side_to, sure.ranges[e].side_to)})
          EXPECT_TRUE(own == 0 || own == truth);
      }
      EXPECT_TRUE(!fast.foot_inside || sure.foot_inside);
      EXPECT_TRUE(!sure.foot || (fast.foot && holds(*fast.foot, *sure.foot)));
    }
  }
  EXPECT_GT(pieces, 300);
  EXPECT_GT(of_points, 100);
  EXPECT_GT(of_planes, 100);
  EXPECT_GT(of_depths, 20);
}

TEST(IntervalPolygon, AnglesHoldEveryDirectionOfABox) {
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> side(-1, 1), part(0, 1), decades(-14, 1);
  for (int trial = 0; trial < 3000; ++trial) {
    const double x = side(random), y = side(random) * (trial % 2 == 0 ? 1 : 1e-9);
    const double w = std::pow(10, decades(random)), h = std::pow(10, decades(random));
    const Interval angle = angle_of({x, x + w}, {y, y + h});
    for (int inner = 0; inner < 4; ++inner) {
      const double there = std::atan2(y + part(random) * h, x + part(random) * w);
      const double turns = std::round((angle.middle() - there) / (2 * std::numbers::pi));
      const double near = there + 2 * std::numbers::pi * turns;
      EXPECT_LE(angle.lo, near + 1e-15) << trial;
      EXPECT_GE(angle.hi, near - 1e-15) << trial;
    }
  }
}

}  // namespace
}  // namespace tubefoot
