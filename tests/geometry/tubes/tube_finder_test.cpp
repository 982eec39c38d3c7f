// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/tubes/tube_finder.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "fixtures/geometry/grid_scenes.hpp"
#include "geometry/tubes/window_tubes.hpp"

namespace tubefoot {
namespace {

std::vector<std::uint32_t> found(const TubeFinder& finder, glm::dvec3 direction) {
  std::vector<std::uint32_t> tubes;
  finder.find(direction, [&](std::uint32_t tube) { tubes.push_back(tube); });
  return tubes;
}

// holds() is exact for integer directions, few of which lie on walls.
TEST(TubeFinder, FindsTheTubesThatHold) {
  const unsigned seed = 4711;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  std::uniform_int_distribution<std::int32_t> place(-1000000, 1000000);
  for (const TubeSet& set :
       {test::forward_tubes({}, 40, 1, 120, 2, 20), test::forward_tubes({}, 7, 30, 170, 160),
        test::forward_tubes({}, 1, 1, 3, 100, 60)}) {
    const TubeFinder finder(set);
    int inside = 0;
    for (int k = 0; k < 4000; ++k) {
      GridPoint d{place(random), place(random), place(random)};
      if (k % 2 == 0) d.y = 2000000;
      std::vector<std::uint32_t> expected;
      for (std::uint32_t tube = 0; tube < set.tubes.size(); ++tube)
        if (holds(set, tube, d)) expected.push_back(tube);
      if (expected.size() > 1) continue;  // on a wall
      ASSERT_EQ(found(finder, {d.x, d.y, d.z}), expected) << d.x << ' ' << d.y << ' ' << d.z;
      inside += !expected.empty();
    }
    EXPECT_GT(inside, set.tubes.size() == 1 ? 10 : 50);
  }
}

TEST(TubeFinder, OnAWallItIsOneOfTheTwo) {
  const TubeSet set = test::lattice_tubes({}, -4, -5, 8, 6, 4);
  const TubeFinder finder(set);
  for (int x = -7; x < 8; ++x)
    for (int z = -9; z < 2; ++z) {
      const std::size_t tubes = found(finder, {x / 2.0, 4, z / 2.0}).size();
      // At a corner of four tubes, each wall decides independently.
      if (x % 2 != 0 || z % 2 != 0) {
        EXPECT_EQ(tubes, 1u) << x << ' ' << z;
      }
    }
}

// Tubes with three corners have a fourth ray on the wall of two others.
TEST(TubeFinder, KnowsWindowsOfThreeCorners) {
  WindowTubes windows({}, 1e9);
  windows.add(std::vector<glm::dvec3>{{0, 0, 1}, {1, 0, 1}, {0, 1, 1}}, 0);
  windows.add(std::vector<glm::dvec3>{{1, 0, 1}, {1, 1, 1}, {0, 1, 1}}, 1);
  const TubeFinder finder(windows.tubes());
  for (int i = 0; i < 40; ++i)
    for (int j = 0; j < 40; ++j) {
      const double x = (i + 0.3) / 40, y = (j + 0.6) / 40;
      ASSERT_EQ(found(finder, {x, y, 1}), (std::vector<std::uint32_t>{x + y < 1 ? 0u : 1u})) << i << ' ' << j;
      ASSERT_TRUE(found(finder, {-x, y, 1}).empty());
    }
}

}  // namespace
}  // namespace tubefoot
