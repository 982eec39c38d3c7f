// SPDX-License-Identifier: GPL-3.0-or-later
// Tests flat and fractal terrain: facets, slopes, reproducible seeds, heights, the Hurst exponent, and
// ripples.

#include "scene/rasters/terrain.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "fixtures/world/mesh_sizes.hpp"

namespace tubefoot {
namespace {

using test::area_from_above;
using testing::HasSubstr;
using testing::ThrowsMessage;

const SourcePlace terrain_place{"scene.toml", 9, 1};

TEST(FlatTerrain, IsTwoFacetsOrAGrid) {
  const FlatTerrain terrain{30, 20, {100, -50, -12}, 0};
  const ComponentMesh two = flat_facets(terrain, terrain_place);
  EXPECT_EQ(two.triangles.size(), 2u);
  EXPECT_DOUBLE_EQ(area_from_above(two), 600);
  EXPECT_EQ(two.points_m.front(), glm::dvec3(85, -60, -12));
  EXPECT_EQ(two.points_m.back(), glm::dvec3(115, -40, -12));

  FlatTerrain cells = terrain;
  cells.cell_m = 0.1;  // 30 / 0.1 is 299.99999999999994 or 300.00000000000006 in double, but 300 cells
  EXPECT_EQ(flat_facets(cells, terrain_place).triangles.size(), std::size_t{2} * 300 * 200);
  cells.cell_m = 7;  // no cell longer than 7 m: 5 x 3 cells of 6 m x 6.67 m
  EXPECT_EQ(flat_facets(cells, terrain_place).triangles.size(), 30u);
  EXPECT_NEAR(area_from_above(flat_facets(cells, terrain_place)), 600, 1e-9);
}

FractalTerrain seabed() {
  FractalTerrain terrain;
  terrain.width_m = 60;
  terrain.length_m = 40;
  terrain.centre_m = {10, 20, -30};
  terrain.cell_m = 0.25;
  terrain.rms_height_m = 0.4;
  terrain.seed = 11;
  return terrain;
}

TEST(Terrain, SlopesFallToTheirHeadingAboutTheMiddle) {
  FlatTerrain flat{30, 20, {100, -50, -12}, 5};
  flat.slope_deg = 30;
  flat.slope_heading_deg = 90;
  for (const glm::dvec3& p : flat_facets(flat, terrain_place).points_m)
    EXPECT_NEAR(p.z, -12 - (p.x - 100) * std::tan(std::numbers::pi / 6), 1e-6);
  flat.slope_deg = 81;
  EXPECT_THROW(flat_facets(flat, terrain_place), InputError);

  FractalTerrain sloping = seabed();
  sloping.slope_deg = 12;
  sloping.slope_heading_deg = -140;
  const ComponentMesh level = fractal_facets(seabed(), terrain_place),
                      tilted = fractal_facets(sloping, terrain_place);
  const double fall = std::tan(12 * std::numbers::pi / 180), h = -140 * std::numbers::pi / 180;
  for (std::size_t i = 0; i < level.points_m.size(); ++i) {
    const glm::dvec3 p = level.points_m[i];
    EXPECT_NEAR(tilted.points_m[i].z - p.z, -fall * (std::sin(h) * (p.x - 10) + std::cos(h) * (p.y - 20)),
                1e-6);
  }
}

TEST(FractalTerrain, SameSeedSameSeabedOtherSeedOtherSeabed) {
  const ComponentMesh a = fractal_facets(seabed(), terrain_place),
                      b = fractal_facets(seabed(), terrain_place);
  EXPECT_EQ(a.points_m, b.points_m);
  FractalTerrain other = seabed();
  other.seed = 12;
  EXPECT_NE(a.points_m, fractal_facets(other, terrain_place).points_m);
}

TEST(FractalTerrain, TheSeabedOfASeedStaysWhatItIs) {
  // These values come from x86-64 with g++ 12. Any other compiler, machine or version must give the same
  // seabed to the micrometre.
  const ComponentMesh mesh = fractal_facets(seabed(), terrain_place);
  EXPECT_NEAR(mesh.points_m[0].z, -30.116611127874801, 1e-7);
  EXPECT_NEAR(mesh.points_m[20000].z, -30.574243436307679, 1e-7);
}

TEST(FractalTerrain, HasItsMeanAndRmsHeight) {
  const ComponentMesh mesh = fractal_facets(seabed(), terrain_place);
  double mean = 0, square = 0;
  for (const glm::dvec3& p : mesh.points_m) {
    mean += p.z + 30;
    square += (p.z + 30) * (p.z + 30);
  }
  const auto n = static_cast<double>(mesh.points_m.size());
  EXPECT_NEAR(mean / n, 0, 1e-12);
  EXPECT_NEAR(std::sqrt(square / n), 0.4, 1e-12);
  EXPECT_NEAR(area_from_above(mesh), 60 * 40, 1e-8);
}

// RMS height difference over `lag` cells along x.
double difference(const ComponentMesh& mesh, std::size_t columns, std::size_t lag) {
  double square = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i + lag < mesh.points_m.size(); ++i) {
    if (i % columns + lag >= columns) continue;
    const double d = mesh.points_m[i + lag].z - mesh.points_m[i].z;
    square += d * d;
    ++count;
  }
  return std::sqrt(square / static_cast<double>(count));
}

TEST(FractalTerrain, HeightDifferencesGrowWithDistanceToThePowerOfHurst) {
  for (const double hurst : {0.2, 0.5, 0.8}) {
    double slope = 0;
    constexpr int kSeeds = 4;
    for (int seed = 1; seed <= kSeeds; ++seed) {
      FractalTerrain terrain = seabed();
      terrain.width_m = terrain.length_m = 128;
      terrain.cell_m = 0.5;
      terrain.hurst = hurst;
      terrain.seed = static_cast<std::uint64_t>(seed);
      const ComponentMesh mesh = fractal_facets(terrain, terrain_place);
      slope += std::log2(difference(mesh, 257, 32) / difference(mesh, 257, 4)) / 3 / kSeeds;
    }
    EXPECT_NEAR(slope, hurst, 0.12);
  }
}

TEST(FractalTerrain, RipplesHaveTheirHeightWavelengthAndDirection) {
  FractalTerrain terrain = seabed();
  terrain.rms_height_m = 0;
  terrain.ripple_height_m = 0.1;
  terrain.ripple_wavelength_m = 4;
  terrain.ripple_direction_deg = 90;  // wave vector to the east: crests run north
  const ComponentMesh mesh = fractal_facets(terrain, terrain_place);
  double lowest = 0, highest = -100;
  for (const glm::dvec3& p : mesh.points_m) {
    EXPECT_NEAR(p.z + 30, 0.05 * std::sin(2 * std::numbers::pi * (p.x - 10) / 4), 1e-6);
    lowest = std::min(lowest, p.z);
    highest = std::max(highest, p.z);
  }
  EXPECT_NEAR(highest - lowest, 0.1, 1e-6);
}

TEST(Terrain, RefusesBadSizes) {
  EXPECT_THAT(
      [] {
        flat_facets({0, 10, {0, 0, 0}, 1}, terrain_place);
      },
      ThrowsMessage<InputError>(testing::AllOf(HasSubstr("scene.toml:9:1"), HasSubstr("width_m"))));
  EXPECT_THAT(
      [] {
        flat_facets({1000, 1000, {0, 0, 0}, 0.01}, terrain_place);
      },
      ThrowsMessage<InputError>(HasSubstr("larger cell_m")));
  EXPECT_THROW(flat_facets({std::nan(""), 10, {0, 0, 0}, 1}, terrain_place), InputError);
  FractalTerrain terrain = seabed();
  terrain.cell_m = -1;
  EXPECT_THROW(fractal_facets(terrain, terrain_place), InputError);
  terrain = seabed();
  terrain.hurst = 1.5;
  EXPECT_THAT([&] { fractal_facets(terrain, terrain_place); }, ThrowsMessage<InputError>(HasSubstr("hurst")));
  terrain = seabed();
  terrain.rms_height_m = -1;
  EXPECT_THROW(fractal_facets(terrain, terrain_place), InputError);
}

}  // namespace
}  // namespace tubefoot
