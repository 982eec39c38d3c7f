// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the integer grid of a scene: dyadic units, rounding to the nearest point, the choice of the finest
// unit, and hashes of grid points.

#include "geometry/numbers/world_grid.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <unordered_set>

namespace tubefoot {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

TEST(WorldGrid, UnitsAreDyadicAndTheOriginIsAMultipleOfTheUnit) {
  const WorldGrid grid(4, {100.03, -7.99, 0.5});
  EXPECT_EQ(grid.unit_m(), 1.0 / 16);
  EXPECT_EQ(grid.origin_m(), glm::dvec3(100.0, -8.0, 0.5));
}

TEST(WorldGrid, SnapsToTheNearestPointTiesAwayFromZero) {
  const WorldGrid grid(0, {0, 0, 0});
  EXPECT_EQ(grid.snap({0.5, -0.5, 1.5}), (GridPoint{1, -1, 2}));
  EXPECT_EQ(grid.snap({0.49999999999999994, -0.49999999999999994, 2.4}), (GridPoint{0, 0, 2}));
}

// Law W2.
TEST(WorldGrid, SnappingMovesAtMostHalfAUnitAndGridPointsNotAtAll) {
  constexpr unsigned kSeed = 20240521;
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::mt19937_64 random(kSeed);
  const glm::dvec3 centre(620152.87, 7246504.91, -52.0);  // UTM: the northing takes 23 bits
  const WorldGrid grid = WorldGrid::fitting(centre - 300.0, centre + 300.0);
  ASSERT_EQ(grid.exponent(), 20);
  std::uniform_real_distribution<double> offset(-300, 300);
  for (int i = 0; i < 10000; ++i) {
    const glm::dvec3 point = centre + glm::dvec3(offset(random), offset(random), offset(random));
    const GridPoint snapped = grid.snap(point);
    const glm::dvec3 back = grid.to_metres(snapped);
    for (int axis = 0; axis < 3; ++axis) EXPECT_LE(std::abs(back[axis] - point[axis]), 0.5 * grid.unit_m());
    EXPECT_EQ(grid.snap(back), snapped);
  }
}

// Law W1.
TEST(WorldGrid, FittingChoosesTheFinestUnitThatHoldsEveryDifference) {
  constexpr std::int64_t kReach = std::int64_t{1} << WorldGrid::coordinate_bits;
  for (double side : {1e-3, 1.0, 511.9, 1023.9, 1024.1, 1e4, 123456.0, 1e9}) {
    const glm::dvec3 lo(-0.3 * side + 17.123, 5.0, -2.0), hi = lo + glm::dvec3(side, 0.5 * side, 0);
    const WorldGrid grid = WorldGrid::fitting(lo, hi);
    const GridPoint a = grid.snap(lo), b = grid.snap(hi);
    EXPECT_LE(std::int64_t{b.x} - a.x, kReach) << side;
    if (grid.exponent() < WorldGrid::finest_exponent) {
      EXPECT_GT(std::ldexp(side, grid.exponent() + 1), static_cast<double>(kReach - 4)) << side;
    }
  }
  EXPECT_EQ(WorldGrid::fitting({0, 0, 0}, {1000, 1000, 50}).exponent(), 20);
  EXPECT_EQ(WorldGrid::fitting({0, 0, 0}, {2000, 1000, 50}).exponent(), 19);
}

TEST(WorldGrid, TranslatingBoxAndPointByGridVectorsChangesNothing) {
  const glm::dvec3 lo(-10, -10, -10), hi(10, 10, 10), shift(4096.25, -1000000.5, 3);
  const WorldGrid here = WorldGrid::fitting(lo, hi), there = WorldGrid::fitting(lo + shift, hi + shift);
  for (const glm::dvec3& p : {glm::dvec3(1.23456789, -9.87, 3.3), glm::dvec3(-0.1, 0.7, 0)}) {
    const glm::dvec3 on_grid = here.to_metres(here.snap(p));
    EXPECT_EQ(here.snap(on_grid), there.snap(on_grid + shift));
  }
}

TEST(WorldGrid, RefusesWhatDoesNotFit) {
  EXPECT_THROW(WorldGrid::fitting({0, 0, 0}, {0, kNan, 0}), GridRangeError);
  EXPECT_THROW(WorldGrid::fitting({-kInf, 0, 0}, {0, 0, 0}), GridRangeError);
  EXPECT_THAT(([] {
                WorldGrid::fitting({0, 0, 0}, {2e9, 0, 0});
              }),
              ThrowsMessage<GridRangeError>(HasSubstr("too large")));
  EXPECT_THAT(([] {
                WorldGrid::with_exponent(20, {0, 0, 0}, {5000, 0, 0});
              }),
              ThrowsMessage<GridRangeError>(HasSubstr("2^-17 m would fit")));
  EXPECT_EQ(WorldGrid::with_exponent(10, {0, 0, 0}, {5000, 0, 0}).exponent(), 10);
  EXPECT_THROW(WorldGrid(-1, {0, 0, 0}), GridRangeError);
  EXPECT_THROW(WorldGrid(60, {0, 0, 0}), GridRangeError);
  const WorldGrid grid(20, {0, 0, 0});
  EXPECT_THROW(grid.snap({kNan, 0, 0}), GridRangeError);
  EXPECT_THROW(grid.snap({0, kInf, 0}), GridRangeError);
  EXPECT_THROW(grid.snap({0, 0, 1024.1}), GridRangeError);
  EXPECT_THROW(grid.snap({0, 0, 1e300}), GridRangeError);
  EXPECT_NO_THROW(grid.snap({0, 0, -1024.0}));
}

TEST(GridPointHash, SpreadsTheNeighboursOfARegularGrid) {
  std::unordered_set<std::size_t> buckets;
  for (int x = 0; x < 64; ++x) {
    for (int y = 0; y < 64; ++y) buckets.insert(GridPointHash{}({x << 18, y << 18, -5}) & 0xffff);
  }
  // 4096 balls in 65536 urns occupy 3969 urns on average, with a standard deviation of 11.
  EXPECT_GT(buckets.size(), 3900u);
}

}  // namespace
}  // namespace tubefoot
