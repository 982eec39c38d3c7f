// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the seabeds of soundings: planes with outliers and of narrow strips, and grids of medians.
#include "exchange/readers/kmall_seabed.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "fixtures/refusal.hpp"

namespace tubefoot {
namespace {

using testing::HasSubstr;

double plane_of_test(double east, double north) { return -12 + 0.03 * east - 0.02 * north; }

std::vector<glm::dvec3> points_on_plane(double length_m, double width_m) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> along(-length_m / 2, length_m / 2),
      across(-width_m / 2, width_m / 2);
  std::vector<glm::dvec3> points;
  for (int k = 0; k < 500; ++k) {
    const double east = 5 + across(random), north = -3 + along(random);
    points.emplace_back(east, north, plane_of_test(east, north));
  }
  return points;
}

void expect_plane_of_test(const FittedPlane& plane) {
  EXPECT_NEAR(plane.slope_east, 0.03, 1e-9);
  EXPECT_NEAR(plane.slope_north, -0.02, 1e-9);
  EXPECT_NEAR(plane.height_m({7, 11}), plane_of_test(7, 11), 1e-9);
  EXPECT_LT(plane.rms_m, 1e-9);
  EXPECT_FALSE(plane.is_narrow);
}

TEST(FittedPlane, OfPointsOnAPlaneIsThePlane) {
  const auto points = points_on_plane(40, 20);
  const FittedPlane plane = fitted_plane(points, 5);
  expect_plane_of_test(plane);
  EXPECT_EQ(plane.used, points.size());
  EXPECT_EQ(plane.removed, 0u);
  for (const glm::dvec3& p : points)
    EXPECT_TRUE(p.x >= plane.lo_m.x && p.x <= plane.hi_m.x && p.y >= plane.lo_m.y && p.y <= plane.hi_m.y);
}

TEST(FittedPlane, OfPointsWithGrossOutliersIsThePlane) {
  auto points = points_on_plane(40, 20);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> error_m(2, 8);
  for (std::size_t k = 0; k < points.size(); k += 5)
    points[k].z += (random() % 2 == 0 ? 1 : -1) * error_m(random);
  const FittedPlane plane = fitted_plane(points, 5);
  expect_plane_of_test(plane);
  EXPECT_EQ(plane.removed, points.size() / 5);
  EXPECT_EQ(plane.used, points.size() - points.size() / 5);
}

TEST(FittedPlane, OfNormalErrorsKeepsNearlyAllPoints) {
  auto points = points_on_plane(40, 20);
  std::mt19937 random(9);
  std::normal_distribution<double> error_m(0, 0.05);
  for (glm::dvec3& p : points) p.z += error_m(random);
  const FittedPlane plane = fitted_plane(points, 5);
  EXPECT_NEAR(plane.rms_m, 0.05, 0.005);
  EXPECT_LE(plane.removed, 1u);
  EXPECT_NEAR(plane.slope_east, 0.03, 0.002);
  EXPECT_NEAR(plane.slope_north, -0.02, 0.002);
}

// The soundings of a ship at anchor: 30 m across the track, 1 m along it, with an error of heave per ping.
TEST(FittedPlane, OfANarrowStripIsLevelInTheDirectionOfItsWidth) {
  for (const double heading : {0.0, 0.5, 2.2}) {
    std::vector<glm::dvec3> points;
    const glm::dvec2 along(std::sin(heading), std::cos(heading)), across(along.y, -along.x);
    for (int ping = 0; ping < 6; ++ping)
      for (int beam = -50; beam <= 50; ++beam)
        points.emplace_back(0.2 * ping * along + 0.3 * beam * across, -8 + 0.01 * 0.3 * beam + 0.1 * ping);
    const FittedPlane plane = fitted_plane(points, 5);
    EXPECT_TRUE(plane.is_narrow);
    const glm::dvec2 slope(plane.slope_east, plane.slope_north);
    EXPECT_NEAR(glm::dot(slope, across), 0.01, 1e-9);
    EXPECT_NEAR(glm::dot(slope, along), 0, 1e-9);
  }
}

TEST(FittedPlane, OfTooFewPointsOrALineIsRejected) {
  expect_refused([] { fitted_plane({}, 5); }, "0 soundings");
  expect_refused([] { fitted_plane({{0, 0, 0}, {1, 2, 3}}, 5); }, "2 soundings");
  expect_refused([] { fitted_plane({{0, 0, 0}, {1, 1, 3}, {2, 2, 5}, {5, 5, 1}}, 5); }, "lie on a line");
  expect_refused([] { fitted_plane({{1, 1, 0}, {1, 1, 3}, {1, 1, 5}}, 5); }, "lie on a line");
  EXPECT_NEAR(fitted_plane({{0, 0, 0}, {1, 0, 2}, {0, 1, 3}}, 5).slope_east, 2, 1e-12);
}

constexpr double any_error_m = 1e9;

/// Soundings in 5 x 5 cells of 1 m, three per cell. The median of cell (i, j) is -10 + 0.1 i - 0.01 j.
std::vector<glm::dvec3> cells_of_test() {
  std::vector<glm::dvec3> points;
  for (int i = 0; i < 5; ++i)
    for (int j = 0; j < 5; ++j) {
      const double median = -10 + 0.1 * i - 0.01 * j;
      points.emplace_back(i, j, median - 0.5 - 0.03 * j);
      points.emplace_back(i, j, median);
      points.emplace_back(i, j, median + 0.25 + 0.02 * i);
    }
  return points;
}

FittedPlane level_plane(double height_m) {
  FittedPlane plane;
  plane.centre_m = {2, 2, height_m};
  plane.lo_m = {0, 0};
  plane.hi_m = {4, 4};
  return plane;
}

double node_at(const SeabedGrid& grid, double east, double north) {
  for (const glm::dvec3& p : grid.points_m)
    if (std::abs(p.x - east) < 1e-9 && std::abs(p.y - north) < 1e-9) return p.z;
  ADD_FAILURE() << "no node at " << east << ", " << north;
  return 0;
}

TEST(SeabedGrid, HasTheMediansOfTheCells) {
  const FittedPlane plane = level_plane(-9);
  const SeabedGrid grid = seabed_grid(cells_of_test(), plane, 1, 2, any_error_m);
  ASSERT_EQ(grid.points_m.size(), 81u);  // from -2 to 6 m
  EXPECT_EQ(grid.filled, 81u - 25);
  EXPECT_EQ(grid.removed, 0u);
  for (int i = 0; i < 5; ++i)
    for (int j = 0; j < 5; ++j) EXPECT_NEAR(node_at(grid, i, j), -10 + 0.1 * i - 0.01 * j, 1e-12);
  // The residuals from the plane spread by the mean of the neighbours.
  EXPECT_NEAR(node_at(grid, -1, 2), -10 - 0.02, 1e-12);
  EXPECT_NEAR(node_at(grid, -1, -1), -10, 1e-12);
  EXPECT_NEAR(node_at(grid, 5, 5), -10 + 0.4 - 0.04, 1e-12);
  double squares = 0;
  for (int i = 0; i < 5; ++i)
    for (int j = 0; j < 5; ++j) squares += std::pow(0.5 + 0.03 * j, 2) + std::pow(0.25 + 0.02 * i, 2);
  EXPECT_NEAR(grid.rms_m, std::sqrt(squares / 75), 1e-12);
}

TEST(SeabedGrid, HasTheHeightOfThePlaneFarFromSoundings) {
  FittedPlane plane = level_plane(-9);
  plane.slope_east = 0.1;
  const SeabedGrid grid = seabed_grid(cells_of_test(), plane, 1, 12, any_error_m);
  EXPECT_NEAR(node_at(grid, 16, 2), plane.height_m({16, 2}), 1e-12);
  EXPECT_NEAR(node_at(grid, -12, -12), plane.height_m({-12, -12}), 1e-12);
  EXPECT_GT(std::abs(node_at(grid, 6, 2) - plane.height_m({6, 2})), 0.1);
}

TEST(SeabedGrid, HasNoOutliers) {
  std::vector<glm::dvec3> points = cells_of_test();
  points.emplace_back(2, 2, -3);
  points.emplace_back(2, 2, 20);
  const SeabedGrid grid = seabed_grid(points, level_plane(-10), 1, 2, 1.5);
  EXPECT_EQ(grid.removed, 2u);
  EXPECT_NEAR(node_at(grid, 2, 2), -10 + 0.2 - 0.02, 1e-12);
}

TEST(SeabedGrid, HasTrianglesThatCoverItAndFaceUp) {
  const SeabedGrid grid = seabed_grid(cells_of_test(), level_plane(-10), 1, 2, any_error_m);
  EXPECT_EQ(grid.triangles.size(), 2u * 8 * 8);
  double area_m2 = 0;
  for (const auto& [a, b, c] : grid.triangles) {
    const glm::dvec3 normal =
        glm::cross(grid.points_m.at(b) - grid.points_m.at(a), grid.points_m.at(c) - grid.points_m.at(a));
    EXPECT_GT(normal.z, 0);
    area_m2 += normal.z / 2;
  }
  EXPECT_NEAR(area_m2, 64, 1e-9);
}

TEST(SeabedGrid, OfTooManyNodesIsRejected) {
  EXPECT_THAT(refusal([] { seabed_grid(cells_of_test(), level_plane(-10), 1e-3, 2, any_error_m); }),
              HasSubstr("increase the cell size"));
}

}  // namespace
}  // namespace tubefoot
