// SPDX-License-Identifier: GPL-3.0-or-later
// Tests tubes from angular grids: rounding of integer rays, orientation of walls, shared rays of adjacent
// tubes, and solid angles of sectors.

#include "geometry/tubes/tube.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <numbers>
#include <random>
#include <set>

#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

std::vector<double> even_edges(double first, double last, int cells) {
  std::vector<double> edges;
  for (int k = 0; k <= cells; ++k) edges.push_back(first + (last - first) * k / cells);
  return edges;
}

/// The frame of the DIDSON: azimuth 0 forward (y), +90 degrees starboard (x), axis up. It is left-handed.
glm::dmat3 left_handed_frame() { return {{0, 1, 0}, {1, 0, 0}, {0, 0, 1}}; }

AngularGrid sector(double horizontal_deg, int azimuth_cells, double vertical_deg, int elevation_cells) {
  return {even_edges(-horizontal_deg / 2 * degree, horizontal_deg / 2 * degree, azimuth_cells),
          even_edges(-vertical_deg / 2 * degree, vertical_deg / 2 * degree, elevation_cells),
          left_handed_frame()};
}

__extension__ using Wide = __int128;
Wide determinant(GridPoint a, GridPoint b, GridPoint c) {
  return (Wide(a.y) * b.z - Wide(a.z) * b.y) * c.x + (Wide(a.z) * b.x - Wide(a.x) * b.z) * c.y +
         (Wide(a.x) * b.y - Wide(a.y) * b.x) * c.z;
}

/// Expects that each ray that is not on a wall is strictly on its inner side: counter-clockwise and convex.
void expect_inward_walls(const TubeSet& set) {
  for (std::size_t t = 0; t < set.tubes.size(); ++t)
    for (std::size_t k = 0; k < 4; ++k)
      for (std::size_t other = 2; other < 4; ++other)
        EXPECT_GT(determinant(set.rays[set.tubes[t][k]], set.rays[set.tubes[t][(k + 1) % 4]],
                              set.rays[set.tubes[t][(k + other) % 4]]),
                  0)
            << "tube " << t << " wall " << k;
}

/// Solid angle of the triangle of three directions (Van Oosterom and Strackee 1983).
long double triangle_solid_angle(GridPoint a, GridPoint b, GridPoint c) {
  using Vector = glm::vec<3, long double>;
  const auto unit = [](GridPoint p) { return glm::normalize(Vector(p.x, p.y, p.z)); };
  const Vector u = unit(a), v = unit(b), w = unit(c);
  return 2 * std::atan2(glm::dot(u, glm::cross(v, w)), 1 + glm::dot(u, v) + glm::dot(v, w) + glm::dot(w, u));
}

double solid_angle(const TubeSet& set) {
  long double sum = 0;
  for (const Tube& tube : set.tubes)
    sum += triangle_solid_angle(set.rays[tube[0]], set.rays[tube[1]], set.rays[tube[2]]) +
           triangle_solid_angle(set.rays[tube[0]], set.rays[tube[2]], set.rays[tube[3]]);
  return double(sum);
}

TEST(Direction, FollowsTheFramesColumns) {
  AngularGrid grid;
  grid.frame = left_handed_frame();
  const auto near = [](glm::dvec3 a, glm::dvec3 b) { return glm::length(a - b) < 1e-15; };
  EXPECT_TRUE(near(direction(grid, 0, 0), {0, 1, 0}));
  EXPECT_TRUE(near(direction(grid, 90 * degree, 0), {1, 0, 0}));
  EXPECT_TRUE(near(direction(grid, 0, 90 * degree), {0, 0, 1}));
  EXPECT_TRUE(near(direction(grid, 90 * degree, 30 * degree), {std::sqrt(0.75), 0, 0.5}));
}

// Law B1.
TEST(IntegerRay, RoundsToNearestAndKeepsToTheBitBudget) {
  constexpr std::int32_t largest = (1 << 30) - 1;
  EXPECT_EQ(integer_ray({1, 0, 0}), (GridPoint{largest, 0, 0}));
  EXPECT_EQ(integer_ray({0, -1, 0}), (GridPoint{0, -largest, 0}));
  EXPECT_EQ(integer_ray({1.4 / largest, -1.6 / largest, 0.6 / largest}), (GridPoint{1, -2, 1}));
  // The angular error is below a grid step of the ray, sqrt(3)/2 * 2^-30 rad.
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 10000; ++i) {
    const glm::dvec3 u = glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
    const GridPoint p = integer_ray(u);
    const double angle = glm::length(glm::cross(u, glm::normalize(glm::dvec3(p.x, p.y, p.z))));
    EXPECT_LT(angle, 8.1e-10) << "seed 7, draw " << i;
  }
}

TEST(AppendTubes, IsAzimuthMajorAndReturnsTheFirst) {
  TubeSet set;
  EXPECT_EQ(append_tubes(set, sector(20, 2, 10, 1)), 0u);
  EXPECT_EQ(append_tubes(set, sector(40, 4, 60, 3)), 2u);
  ASSERT_EQ(set.tubes.size(), 2u + 12u);
  ASSERT_EQ(set.rays.size(), 3u * 2u + 5u * 4u);
  // Tube (3, 2) is the starboard-most and highest cell of the second grid. The mean of its rays points
  // there.
  const Tube& tube = set.tubes[2 + 3 * 3 + 2];
  glm::dvec3 mean(0);
  for (const auto corner : tube)
    mean += glm::dvec3(set.rays[corner].x, set.rays[corner].y, set.rays[corner].z);
  mean = glm::normalize(mean);
  EXPECT_NEAR(std::atan2(mean.x, mean.y) / degree, 15, 0.1);
  EXPECT_NEAR(std::asin(mean.z) / degree, 20, 0.5);
}

// Law B3.
TEST(AppendTubes, WallsPointInwardInEitherHandednessAndAnyAttitude) {
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 200; ++i) {
    const glm::dquat turn =
        glm::normalize(glm::dquat(normal(random), normal(random), normal(random), normal(random)));
    for (const bool mirrored : {false, true}) {
      AngularGrid grid = sector(170, 5, 160, 3);
      grid.frame = glm::mat3_cast(turn);
      if (mirrored) grid.frame[0] = -grid.frame[0];
      TubeSet set;
      append_tubes(set, grid);
      SCOPED_TRACE(testing::Message() << "seed 11, draw " << i << (mirrored ? ", mirrored" : ""));
      expect_inward_walls(set);
    }
  }
}

// Law B2.
TEST(AppendTubes, NeighboursShareRaysSoThatTheyPartitionTheSector) {
  TubeSet set;
  const int columns = 7, rows = 4;
  append_tubes(set, sector(100, columns, 60, rows));
  ASSERT_EQ(set.rays.size(), std::size_t((columns + 1) * (rows + 1)));  // no ray is duplicated
  // Each wall inside the sector occurs once in either direction, and each wall of the border once.
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> walls;
  for (const Tube& tube : set.tubes)
    for (std::size_t k = 0; k < 4; ++k) ++walls[{tube[k], tube[(k + 1) % 4]}];
  int border = 0;
  for (const auto& [wall, count] : walls) {
    EXPECT_EQ(count, 1);
    if (!walls.contains({wall.second, wall.first})) ++border;
  }
  EXPECT_EQ(border, 2 * (columns + rows));
}

// Law B2.
TEST(AppendTubes, AFullTurnHasNoSeam) {
  TubeSet set;
  append_tubes(set, sector(360, 36, 40, 1));
  EXPECT_EQ(set.rays.size(), 36u * 2u);
  expect_inward_walls(set);
  // Closed form of the band between the great-circle walls: 36 pyramids (see below).
  const double half = 5 * degree, middle = std::atan(std::tan(20 * degree) / std::cos(half));
  EXPECT_NEAR(solid_angle(set), 36 * 4 * std::asin(std::sin(half) * std::sin(middle)), 1e-8);
}

// physics.md 7.3. The upper and lower walls of a cell are great circles through its corners. A cell of half
// azimuth a and corner elevation +-e is thus a rectangular pyramid of half angles a and e' = atan(tan e /
// cos a). Law B2.
TEST(AppendTubes, SolidAnglesSumToTheSectors) {
  const auto pyramid = [](double half_azimuth, double corner_elevation) {
    return 4 * std::asin(std::sin(half_azimuth) *
                         std::sin(std::atan(std::tan(corner_elevation) / std::cos(half_azimuth))));
  };
  TubeSet single;
  append_tubes(single, sector(29, 1, 14, 1));
  EXPECT_NEAR(solid_angle(single), pyramid(14.5 * degree, 7 * degree), 1e-9);

  TubeSet beams;  // those of the DIDSON
  append_tubes(beams, sector(29, 96, 14, 1));
  EXPECT_NEAR(solid_angle(beams), 96 * pyramid(29.0 / 192 * degree, 7 * degree), 1e-9);
  EXPECT_NEAR(solid_angle(beams), 0.123367235381, 1e-6);

  // many narrow cells: the great circles converge to the cones of constant elevation, as azimuth^2 / 12
  TubeSet fine;
  append_tubes(fine, sector(29, 1000, 14, 1));
  EXPECT_NEAR(solid_angle(fine) / 0.123367235381, 1, 1e-7);

  // A division in elevation changes nothing: inner walls are shared.
  TubeSet split;
  append_tubes(split, sector(29, 96, 14, 5));
  EXPECT_NEAR(solid_angle(split), solid_angle(beams), 1e-9);
}

TEST(AppendTubes, RefusesWhatIsNoPyramid) {
  const auto refused = [](AngularGrid grid) {
    TubeSet set;
    append_tubes(set, sector(20, 2, 10, 1));
    const TubeSet before = set;
    EXPECT_THROW(append_tubes(set, grid), std::invalid_argument);
    EXPECT_EQ(set, before) << "a refused grid leaves nothing behind";
  };
  refused(sector(180, 1, 14, 1));  // azimuth cell of pi
  refused(sector(300, 1, 14, 1));
  refused(sector(370, 20, 14, 1));  // overlaps itself
  refused(sector(29, 4, 180, 2));   // up to the axis
  refused(sector(29, 4, 200, 2));
  refused({{0.0}, {0.0, 0.1}, glm::dmat3(1)});  // no cell
  refused({{}, {}, glm::dmat3(1)});
  refused({{0.0, 0.1, 0.1}, {0.0, 0.1}, glm::dmat3(1)});  // edges that do not increase
  refused({{0.0, 0.1}, {0.1, 0.0}, glm::dmat3(1)});
  refused({{0.0, std::nan("")}, {0.0, 0.1}, glm::dmat3(1)});
  refused({{0.0, INFINITY}, {0.0, 0.1}, glm::dmat3(1)});
  refused({{0.0, 1e-10}, {0.0, 0.1}, glm::dmat3(1)});  // two rays coincide after rounding
  refused({{0.0, 0.1}, {0.0, 1e-10}, glm::dmat3(1)});
  const double near_axis = std::numbers::pi / 2 - 1e-10;
  refused({{0.0, 0.1}, {0.0, near_axis}, glm::dmat3(1)});
}

TEST(AppendTubes, TheNarrowestCellsThatAreTakenAreExactPyramids) {
  TubeSet set;
  append_tubes(set, {{0.0, 4e-9, 8e-9}, {-4e-9, 4e-9}, left_handed_frame()});
  expect_inward_walls(set);
}

// Law B5.
TEST(EnclosingPyramid, HasAllRaysStrictlyInside) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> share(0, 1);
  std::size_t enclosed = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const int columns = 1 + trial % 40, rows = 1 + trial % 3;
    AngularGrid grid = sector(1 + 60 * share(random), columns, 1 + 50 * share(random), rows);
    grid.frame = grid.frame * glm::dmat3(glm::mat3_cast(glm::normalize(glm::dquat(
                                  share(random) - 0.5, share(random), share(random), share(random)))));
    TubeSet set;
    append_tubes(set, grid);
    const auto first = static_cast<std::uint32_t>(share(random) * double(set.tubes.size() - 1));
    const auto pyramid = enclosing_pyramid(set, first, static_cast<std::uint32_t>(set.tubes.size()));
    if (!pyramid) continue;
    ++enclosed;
    for (std::size_t t = first; t < set.tubes.size(); ++t)
      for (const std::uint32_t ray : set.tubes[t])
        for (std::size_t k = 0; k < 4; ++k)
          EXPECT_GT(determinant((*pyramid)[k], (*pyramid)[(k + 1) % 4], set.rays[ray]), 0)
              << "trial " << trial << ", tube " << t << ", wall " << k;
  }
  EXPECT_GT(enclosed, 150u);
}

TEST(EnclosingPyramid, IsTight) {
  TubeSet set;
  append_tubes(set, sector(4, 32, 20, 1));
  const auto pyramid = enclosing_pyramid(set, 0, 32);
  ASSERT_TRUE(pyramid);
  const auto solid_angle = [](GridPoint a, GridPoint b, GridPoint c, GridPoint d) {
    return double(triangle_solid_angle(a, b, c) + triangle_solid_angle(a, c, d));
  };
  double tubes = 0;
  for (const Tube& t : set.tubes)
    tubes += solid_angle(set.rays[t[0]], set.rays[t[1]], set.rays[t[2]], set.rays[t[3]]);
  const double whole = solid_angle((*pyramid)[0], (*pyramid)[1], (*pyramid)[2], (*pyramid)[3]);
  EXPECT_GT(whole, tubes);
  EXPECT_LT(whole, 1.02 * tubes);
}

TEST(EnclosingPyramid, OfTubesInAllDirectionsDoesNotExist) {
  TubeSet turn;
  append_tubes(turn, sector(360, 12, 20, 1));
  EXPECT_FALSE(enclosing_pyramid(turn, 0, 12));
  EXPECT_TRUE(enclosing_pyramid(turn, 0, 2));
  EXPECT_FALSE(enclosing_pyramid(turn, 3, 4)) << "a single tube is its own pyramid";
}

}  // namespace
}  // namespace tubefoot
