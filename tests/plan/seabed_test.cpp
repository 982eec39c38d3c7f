// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the seabed of a drawing against closed forms: heights of planes, distances to planes, profiles, and
// terrain of many tiles.
#include "plan/seabed.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "fixtures/scene_texts.hpp"
#include "fixtures/test_folder.hpp"
#include "sensors/kinds/scene_file.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

double plane(double x, double y) { return -10 + 0.1 * x - 0.25 * y; }
glm::dvec3 on_plane(double x, double y) { return {x, y, plane(x, y)}; }

/// Two facets over a square of 20 x 20 m.
template <class Take>
void square(const Take& take) {
  take({on_plane(-10, -10), on_plane(10, -10), on_plane(10, 10)});
  take({on_plane(-10, -10), on_plane(10, 10), on_plane(-10, 10)});
}

PlanHeights square_map(const Window& window, int cells = 100) {
  PlanHeights map(window, cells);
  square([&](const std::array<glm::dvec3, 3>& facet) { map.add(facet); });
  return map;
}

TEST(PlanHeights, HoldsAPlaneAndNothingBesideIt) {
  const PlanHeights map = square_map({{-20, -15}, {20, 15}});
  EXPECT_EQ(map.columns(), 100);
  EXPECT_EQ(map.rows(), 75);
  int covered = 0;
  for (int row = 0; row < map.rows(); ++row)
    for (int column = 0; column < map.columns(); ++column) {
      const double x = -20 + 0.4 * (column + 0.5), y = -15 + 0.4 * (row + 0.5), up = map.up_m(column, row);
      if (std::abs(x) > 10 || std::abs(y) > 10) {
        EXPECT_TRUE(std::isnan(up)) << x << " " << y;
      } else {
        EXPECT_NEAR(up, plane(x, y), 1e-9);
        ++covered;
      }
    }
  EXPECT_EQ(covered, 50 * 51);  // rows lie on the borders of 20 m, columns next to them
  EXPECT_NEAR(*map.at({3.21, -4.56}), plane(3.21, -4.56), 1e-9);
  EXPECT_FALSE(map.at({15, 0}).has_value());
  EXPECT_FALSE(map.at({1e9, std::nan("")}).has_value());
}

TEST(PlanHeights, KeepsTheHighestAndTakesNoUprightFacet) {
  PlanHeights map = square_map({{-10, -10}, {10, 10}});
  map.add({glm::dvec3(-1, -1, 5), {1, -1, 5}, {0, 1, 5}});
  map.add({glm::dvec3(-10, 0, 90), {10, 0, 90}, {0, 0, 99}});
  EXPECT_NEAR(*map.at({0.1, 0.1}), 5, 1e-9);
  EXPECT_EQ(map.highest_m(), 5);
}

TEST(PlanHeights, FindsTheDistanceToAPlane) {
  const PlanHeights map = square_map({{-10, -10}, {10, 10}}, 300);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-6, 6), aside(-0.4, 0.4), height(0.5, 4);
  const glm::dvec3 normal(-0.1, 0.25, 1);
  for (int k = 0; k < 500; ++k) {
    const glm::dvec3 from = on_plane(place(random), place(random)) + glm::dvec3(0, 0, height(random)),
                     way = glm::normalize(glm::dvec3(aside(random), aside(random), -1));
    const double expected = glm::dot(on_plane(0, 0) - from, normal) / glm::dot(way, normal);
    const auto found = map.distance_m(from, way, 100);
    ASSERT_TRUE(found.has_value());
    EXPECT_NEAR(*found, expected, 1e-3);
    EXPECT_FALSE(map.distance_m(from, way, 0.9 * expected).has_value()) << "not so far";
    EXPECT_FALSE(map.distance_m(from, -way, 100).has_value()) << "looks up";
  }
  EXPECT_FALSE(map.distance_m({0, 0, -20}, {0, 0, -1}, 100).has_value()) << "from below";
  EXPECT_FALSE(map.distance_m({500, 0, 0}, {0, 0, -1}, 100).has_value()) << "beside";
  EXPECT_TRUE(map.distance_m({500, 0, 0}, glm::normalize(glm::dvec3(-50, 0, -1)), 1e7).has_value());
  EXPECT_FALSE(map.distance_m({0, 0, 0}, {std::nan(""), 0, 0}, 1e7).has_value());
}

TEST(PlanHeights, OfNothingIsEmpty) {
  const PlanHeights map({{0, 0}, {1, 1}}, 10);
  EXPECT_TRUE(map.empty());
  EXPECT_FALSE(map.distance_m({0, 0, 0}, {0, 0, -1}, 100).has_value());
}

TEST(Profile, CutsAPlaneWhereItIs) {
  Profile cut(-15, 15, 60), between(-15, 15, 60);
  // A profile along x through y = 4. Facets south of it lie before the drawing plane.
  square([&](const std::array<glm::dvec3, 3>& facet) {
    std::array<glm::dvec3, 3> turned;
    for (std::size_t k = 0; k < 3; ++k) turned[k] = {facet[k].x, facet[k].z, 4 - facet[k].y};
    cut.add(turned, true);
    between.add(turned, false);
  });
  for (std::size_t k = 0; k < 60; ++k) {
    const double x = -15 + 0.5 * (double(k) + 0.5);
    ASSERT_EQ(cut.has(k), std::abs(x) < 10) << x;
    ASSERT_EQ(between.has(k), cut.has(k));
    if (!cut.has(k)) continue;
    EXPECT_NEAR(cut.highest_m(k), plane(x, 4), 1e-9);
    EXPECT_NEAR(cut.lowest_m(k), plane(x, 4), 1e-9);
    EXPECT_NEAR(between.highest_m(k), plane(x, -10), 1e-9);
    EXPECT_NEAR(between.lowest_m(k), plane(x, 10), 1e-9);
  }
}

TEST(Profile, GoesThroughVerticesOfItsPlane) {
  Profile cut(-10, 10, 40);  // y = 0 contains an edge of four facets
  for (const double side : {-1.0, 1.0})
    for (const double end : {-10.0, 10.0}) cut.add({glm::dvec3(0, 1, 0), {end, 1, 0}, {end, 3, side}}, true);
  for (std::size_t k = 0; k < 40; ++k) EXPECT_NEAR(cut.highest_m(k), 1, 1e-9) << k;
}

// The terrain has too many tiles to read all: it is coarse as a whole, and exact where the drawing needs
// few tiles.
TEST(TerrainFacets, ManyTilesAreDrawnByTheirExtentsAndFewAreRead) {
  constexpr int cells = 1350;  // 22 x 22 tiles
  std::string row, grid = fmt::format("ncols {0}\nnrows {0}\nxllcorner 0\nyllcorner 0\ncellsize 4\n", cells);
  for (int column = 0; column < cells; ++column) row += fmt::format("{} ", column);
  for (int k = 0; k < cells; ++k) grid += row + "\n";
  const TestFolder folder;
  folder.write("bed.asc", grid);
  const fs::path scene = folder.write(
      "scene.toml", lambert_material("sand", -27) +
                        "[[terrain]]\nkind = \"raster\"\nfile = \"bed.asc\"\nload = \"tiles\"\n" +
                        fixed_at(2000, 2000, 1500) + "[[sensors]]\nname = \"eye\"\nkind = \"didson\"\n");
  const auto survey = open_survey(read_scene_file(scene));
  const auto up = [](double x) { return x / 4 - 0.5; };
  const auto largest_error = [&](const Window& window, bool coarse) {
    PlanHeights map(window, 90);
    EXPECT_EQ(each_terrain_facet(*survey, window, [&](const auto& facet) { map.add(facet); }), coarse);
    double error = 0;
    for (int r = 0; r < map.rows(); ++r)
      for (int c = 0; c < map.columns(); ++c)
        error = std::max(error, std::abs(map.up_m(c, r) - up(window.lo_m.x + map.cell_m() * (c + 0.5))));
    return error;
  };
  EXPECT_LT(largest_error({{1000, 1000}, {1500, 1400}}, false), 1e-6);
  EXPECT_LT(largest_error({{100, 100}, {5300, 5300}}, true), 64 * 4 * 0.25 / 2) << "half a tile's rise";
}

}  // namespace
}  // namespace tubefoot
