// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the cubic spline surface through a height map. It interpolates the nodes, is smooth across seams,
// and falls to zero outside of a map without repetition.

#include "engine/relief/map_surface.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace tubefoot {
namespace {

HeightMap random_map(std::size_t columns, std::size_t rows, bool periodic) {
  HeightMap map{columns, rows, 100.25, -50, 0.5, 0.25, periodic, std::vector<double>(columns * rows)};
  std::mt19937_64 random(columns);
  std::uniform_real_distribution<double> height(-1, 1);
  for (double& h : map.height_m) h = height(random);
  return map;
}

TEST(MapSurface, GoesThroughItsNodes) {
  for (const bool periodic : {true, false})
    for (const auto& [columns, rows] : {std::pair<std::size_t, std::size_t>{2, 2}, {3, 100}, {57, 20}}) {
      const HeightMap map = random_map(columns, rows, periodic);
      const auto surface = make_surface(map);
      for (std::size_t j = 0; j < rows; ++j)
        for (std::size_t i = 0; i < columns; ++i) {
          const glm::dvec3 place(100.25 + 0.5 * static_cast<double>(i), -50 + 0.25 * static_cast<double>(j),
                                 9);
          EXPECT_NEAR(surface->height_m(place), map.height_m[j * columns + i], 2e-6) << columns << periodic;
          if (periodic) {
            EXPECT_NEAR(surface->height_m(place + glm::dvec3(3 * 0.5 * static_cast<double>(columns),
                                                             -7 * 0.25 * static_cast<double>(rows), 0)),
                        map.height_m[j * columns + i], 2e-6);
          }
        }
    }
}

TEST(MapSurface, BetweenNodesItIsTheCardinalSpline) {
  // The cubic spline that is 1 at one integer and 0 at all others has the coefficients sqrt(3) (sqrt(3) -
  // 2)^|k|.
  const auto cardinal = [](double x) {
    const auto spline = [](double t) {
      t = std::abs(t);
      return t < 1 ? 2.0 / 3 - t * t + t * t * t / 2 : t < 2 ? (2 - t) * (2 - t) * (2 - t) / 6 : 0.0;
    };
    double sum = 0;
    for (int k = -30; k <= 30; ++k)
      sum += std::sqrt(3.0) * std::pow(std::sqrt(3.0) - 2, std::abs(k)) * spline(x - k);
    return sum;
  };
  for (const bool periodic : {true, false}) {
    HeightMap map{60, 60, 0, 0, 1, 1, periodic, std::vector<double>(3600)};
    map.height_m[30 * 60 + 30] = 2;
    const auto surface = make_surface(map);
    std::mt19937_64 random(2);
    std::uniform_real_distribution<double> at(20, 40);
    for (int n = 0; n < 500; ++n) {
      const double x = at(random), y = at(random);
      EXPECT_NEAR(surface->height_m({x, y, 0}), 2 * cardinal(x - 30) * cardinal(y - 30), 1e-6);
    }
  }
}

TEST(MapSurface, EndsInHeightZeroUnlessRepeated) {
  HeightMap map = random_map(20, 30, false);
  for (double& h : map.height_m) h += 5;
  const auto surface = make_surface(map);
  const double border_x = static_cast<double>(kMapBorder) * 0.5,
               border_y = static_cast<double>(kMapBorder) * 0.25;
  EXPECT_EQ(surface->height_m({100.25 - border_x, -48, 0}), 0);
  EXPECT_EQ(surface->height_m({100.25 + 19 * 0.5 + border_x, -48, 0}), 0);
  EXPECT_EQ(surface->height_m({102, -50 - border_y, 0}), 0);
  EXPECT_EQ(surface->height_m({102, -50 + 29 * 0.25 + border_y, 0}), 0);
  EXPECT_EQ(surface->height_m({1e9, -1e12, 0}), 0);
  EXPECT_EQ(surface->height_m({std::nan(""), HUGE_VAL, 0}), 0);
  // The neighbours of the outermost nodes are 0, like all nodes farther out.
  EXPECT_NEAR(surface->height_m({100.25 - 0.5, -48, 0}), 0, 1e-6);
  EXPECT_NEAR(surface->height_m({102.25, -50 - 3 * 0.25, 0}), 0, 1e-6);
}

TEST(MapSurface, IsSmoothAcrossNodesSeamsAndItsEnd) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> at(0, 1);
  for (const bool periodic : {true, false}) {
    const auto surface = make_surface(random_map(20, 30, periodic));
    const double curvature = surface->left_out(1e-3).largest_height_m * 6 / 1e-6;
    for (int n = 0; n < 2000; ++n) {
      // The points lie on a line of nodes. Some of these lines are the seam or the end of the padded map.
      const double x = 100.25 + 0.5 * (n % 80 - 30), y = -55 + 20 * at(random);
      const glm::dvec3 here(n % 2 == 0 ? x : 90 + 30 * at(random),
                            n % 2 == 0 ? y : -50 + 0.25 * (n % 90 - 30), 0);
      const double e = 1e-5;
      for (const glm::dvec3& way : {glm::dvec3(e, 0, 0), glm::dvec3(0, e, 0)}) {
        const double west = surface->height_m(here - way), mid = surface->height_m(here),
                     east = surface->height_m(here + way);
        EXPECT_LE(std::abs(west - 2 * mid + east), curvature * e * e + 1e-14) << periodic << " " << n;
        EXPECT_LE(std::abs(east - mid), surface->left_out(1e9).largest_slope / 3 * e + 1e-14);
      }
    }
  }
}

TEST(MapSurface, KnowsItsRootMeanSquareAboutTheMean) {
  HeightMap map = random_map(31, 64, true);
  double mean = 0, square = 0;
  for (double& h : map.height_m) mean += (h += 3) / (31 * 64);
  for (const double h : map.height_m) square += (h - mean) * (h - mean) / (31 * 64);
  const auto surface = make_surface(map);
  EXPECT_NEAR(surface->rms_height_m(), std::sqrt(square), 1e-6);
  EXPECT_GE(surface->largest_m(), 3.9);
  EXPECT_EQ(surface->finest_m(), 0.25);
}

}  // namespace
}  // namespace tubefoot
