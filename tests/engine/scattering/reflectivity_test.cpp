// SPDX-License-Identifier: GPL-3.0-or-later
// Tests reflectivity textures (micro-texture): the definition of Perlin noise and of maps, means, bounds,
// and the cells in which the factor is smooth.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <glm/geometric.hpp>
#include <limits>
#include <random>

#include "engine/scattering/layered_reflectivity.hpp"
#include "engine/scattering/map_reflectivity.hpp"
#include "engine/scattering/perlin_reflectivity.hpp"

namespace tubefoot {
namespace {

using Settings = PerlinReflectivity::Settings;
using Field = std::shared_ptr<const ReflectivityField>;

TEST(PerlinReflectivity, HasThePublishedNoise) {
  // The wavelength is 2, with the reference permutation: coordinates are twice the published ones.
  const PerlinReflectivity field({.wavelength_m = 2, .seed = 0});
  EXPECT_NEAR(field.factor({6.28, 84, 14}), 1 + 0.25 * 0.13691995878400012, 1e-15);
  EXPECT_NEAR(field.factor({-8.40, 20, 12}), 1 + 0.25 * 0.14208000000000043, 1e-15);
  EXPECT_EQ(field.factor({4, -6, 18}), 1);
}

TEST(PerlinReflectivity, OctavesAreAWeightedMean) {
  const PerlinReflectivity octaves(
      {.wavelength_m = 0.8, .octaves = 3, .persistence = 0.6, .depth = 0.4, .seed = 9});
  const PerlinLattice noise(9);
  const glm::dvec3 p{1.23, -4.56, 0.78}, q = p / 0.8;
  const double sum =
      noise(q.x, q.y, q.z) + 0.6 * noise(2 * q.x, 2 * q.y, 2 * q.z) + 0.36 * noise(4 * q.x, 4 * q.y, 4 * q.z);
  EXPECT_NEAR(octaves.factor(p), 1 + 0.4 * sum / 1.96, 1e-14);
  EXPECT_NEAR(octaves.finest_m(), 0.2, 1e-16);
}

TEST(PerlinReflectivity, AQuarterOfTheDiffuseComponentHasTheSheetsDeviation) {
  const unsigned seed = 66;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(-300, 300);
  const PerlinReflectivity field({.wavelength_m = 0.5});
  const int n = 400000;
  double sum = 0, squares = 0;
  for (int i = 0; i < n; ++i) {
    const double deviation = field.factor({place(random), place(random), place(random)}) - 1;
    sum += deviation;
    squares += deviation * deviation;
  }
  EXPECT_NEAR(sum / n, 0, 5e-4);
  EXPECT_NEAR(std::sqrt(squares / n), 0.25 * 0.2704, 4e-4);
}

TEST(PerlinReflectivity, TheMeanOver256CellsAlongAnyAxisIsOne) {
  for (const std::uint64_t seed : {0, 1, 77})
    for (const glm::dvec3 axis : {glm::dvec3{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}) {
      const PerlinReflectivity field({.wavelength_m = 1, .depth = 0.9, .seed = seed});
      double sum = 0;
      for (int i = 0; i < 256; ++i) sum += field.factor(glm::dvec3{0.3, 17.6, -5.2} + double(i) * axis);
      EXPECT_NEAR(sum / 256, 1, 1e-14) << seed;
    }
}

TEST(PerlinReflectivity, RefusesWhatIsNoTexture) {
  const double nan = std::nan(""), infinite = std::numeric_limits<double>::infinity();
  for (const Settings& s : std::vector<Settings>{{.wavelength_m = 0},
                                                 {.wavelength_m = -1},
                                                 {.wavelength_m = nan},
                                                 {.wavelength_m = infinite},
                                                 {.octaves = 0},
                                                 {.octaves = 17},
                                                 {.persistence = -0.1},
                                                 {.persistence = 1.1},
                                                 {.persistence = nan},
                                                 {.depth = -0.1},
                                                 {.depth = 0.97},
                                                 {.depth = nan}})
    EXPECT_THROW(PerlinReflectivity{s}, std::invalid_argument);
}

MapReflectivity::Grid grid(std::size_t columns, std::size_t rows, std::vector<float> values) {
  return {columns, rows, std::move(values)};
}

TEST(MapReflectivity, IsBilinearBetweenPixelsOverTheirMean) {
  const MapReflectivity map(grid(2, 2, {1, 2, 3, 6}), {{10, 20}, {0.5, 0}, {0, -0.25}, false});
  EXPECT_NEAR(map.factor({10, 20, -7}), 1.0 / 3, 1e-7);
  EXPECT_NEAR(map.factor({10.5, 20, 0}), 2.0 / 3, 1e-7);
  EXPECT_NEAR(map.factor({10, 19.75, 0}), 1, 1e-7);
  EXPECT_NEAR(map.factor({10.25, 19.875, 0}), 1, 1e-7);
  EXPECT_NEAR(map.factor({10.375, 20, 0}), 0.25 / 3 + 0.75 * 2 / 3, 1e-7);
  EXPECT_NEAR(map.largest(), 2, 1e-6);
}

TEST(MapReflectivity, HasOneAroundItAndForPixelsWithoutData) {
  const float none = std::nanf("");
  const MapReflectivity map(grid(3, 1, {2, none, 6}), {{0, 0}, {1, 0}, {0, 1}, false});
  EXPECT_NEAR(map.factor({0, 0, 0}), 0.5, 1e-7);
  EXPECT_NEAR(map.factor({1, 0, 0}), 1, 1e-7);
  EXPECT_NEAR(map.factor({2, 0, 0}), 1.5, 1e-7);
  EXPECT_NEAR(map.factor({2.5, 0, 0}), 1.25, 1e-7);
  for (const glm::dvec3 p : {glm::dvec3{3, 0, 0}, {-1, 0, 0}, {1, 1, 0}, {2, -1.5, 0}, {1e7, -1e7, 0}})
    EXPECT_EQ(map.factor(p), 1);
}

TEST(MapReflectivity, ATileRepeatsWithTheMeanOne) {
  const unsigned seed = 5;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<float> value(0, 9);
  std::vector<float> values;
  for (int i = 0; i < 12; ++i) values.push_back(value(random));
  const MapReflectivity map(grid(4, 3, values), {{0.1, 0.2}, {0.5, 0.1}, {-0.1, 0.4}, true});
  const glm::dvec3 right = 4.0 * glm::dvec3{0.5, 0.1, 0}, up = 3.0 * glm::dvec3{-0.1, 0.4, 0};
  double sum = 0;
  const int n = 24;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const glm::dvec3 p = (i + 0.37) / n * right + (j + 0.81) / n * up;
      sum += map.factor(p);
      EXPECT_NEAR(map.factor(p), map.factor(p + 7.0 * right - 4.0 * up), 1e-6);
    }
  // Midpoints of an even number of parts per cell are exact for a bilinear function.
  EXPECT_NEAR(sum / (n * n), 1, 1e-6);
}

TEST(MapReflectivity, RefusesWhatIsNoMap) {
  const MapReflectivity::Placing placing;
  EXPECT_THROW(MapReflectivity({}, placing), std::invalid_argument);
  EXPECT_THROW(MapReflectivity(grid(2, 2, {1, 2, 3}), placing), std::invalid_argument);
  EXPECT_THROW(MapReflectivity(grid(2, 1, {1, -1}), placing), std::invalid_argument);
  EXPECT_THROW(MapReflectivity(grid(2, 1, {0, 0}), placing), std::invalid_argument);
  EXPECT_THROW(MapReflectivity(grid(1, 1, {std::nanf("")}), placing), std::invalid_argument);
  EXPECT_THROW(MapReflectivity(grid(1, 1, {std::numeric_limits<float>::infinity()}), placing),
               std::invalid_argument);
  EXPECT_THROW(MapReflectivity(grid(1, 1, {1}), {{0, 0}, {1, 1}, {2, 2}, false}), std::invalid_argument);
  EXPECT_THROW(LayeredReflectivity({}), std::invalid_argument);
}

std::vector<std::pair<std::string, Field>> fields() {
  const Field octaves = std::make_shared<PerlinReflectivity>(Settings{.octaves = 4, .depth = 0.9, .seed = 2});
  const Field map = std::make_shared<MapReflectivity>(
      grid(3, 2, {0, 5, 1, 2, 8, 1}), MapReflectivity::Placing{{0.2, 0.1}, {0.3, 0.1}, {-0.2, 0.5}, true});
  return {{"octaves", octaves},
          {"map", map},
          {"layers", std::make_shared<LayeredReflectivity>(std::vector{octaves, map})}};
}

/// Returns the cell of each family that contains a position.
std::vector<double> cell_of(const ReflectivityField& field, glm::dvec3 p) {
  std::vector<double> cell;
  for (const CellPlanes& planes : field.cells())
    cell.push_back(std::floor((glm::dot(planes.normal, p) - planes.offset_m) / planes.spacing_m));
  return cell;
}

TEST(ReflectivityFields, AreWithinTheirBoundsAndSmoothInTheirCells) {
  const unsigned seed = 8;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(-20, 20);
  std::normal_distribution<double> gauss;
  for (const auto& [name, field] : fields()) {
    int whole = 0;
    for (int i = 0; i < 20000; ++i) {
      const glm::dvec3 p{place(random), place(random), place(random)};
      const double factor = field->factor(p);
      ASSERT_GE(factor, 0) << name;
      ASSERT_LE(factor, field->largest()) << name;
      const glm::dvec3 step = 0.001 * glm::normalize(glm::dvec3(gauss(random), gauss(random), gauss(random)));
      if (cell_of(*field, p) != cell_of(*field, p + 3.0 * step)) continue;
      ++whole;
      const double change = std::abs(field->factor(p + 3.0 * step) - factor);
      ASSERT_LE(change, field->change(0.003) + 1e-12) << name;
      if (name != "map") continue;  // quadratic along a line
      const double third = field->factor(p + 3.0 * step) - 3 * field->factor(p + 2.0 * step) +
                           3 * field->factor(p + step) - factor;
      ASSERT_NEAR(third, 0, 1e-11) << name;
    }
    EXPECT_GT(whole, 10000) << name;
  }
}

TEST(ReflectivityFields, ChangeBoundsThePolynomialOfACellAtComplexPlacesToo) {
  const unsigned seed = 12;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> inside(0, 1), angle(0, 6.2832);
  std::normal_distribution<double> gauss;
  const PerlinReflectivity field({.wavelength_m = 1, .octaves = 1, .depth = 0.5, .seed = 3});
  using Complex = std::complex<double>;
  for (const double away : {0.01, 0.1, 0.5, 1.0, 3.0}) {
    double largest = 0;
    for (int i = 0; i < 20000; ++i) {
      const glm::dvec3 p{inside(random), inside(random), inside(random)};
      const glm::dvec3 d = glm::normalize(glm::dvec3(gauss(random), gauss(random), gauss(random)));
      const Complex z = std::polar(away, angle(random));
      const auto cell = [&](auto x, auto y, auto z3) {
        return field.lattice().in_cell<Complex>(std::int64_t(i), std::int64_t(i / 256), 5, Complex(x),
                                                Complex(y), Complex(z3));
      };
      largest = std::max(
          largest, 0.5 * std::abs(cell(p.x + z * d.x, p.y + z * d.y, p.z + z * d.z) - cell(p.x, p.y, p.z)));
    }
    EXPECT_LE(largest, field.change(away)) << away;
    // the bound is not far too large
    EXPECT_GE(largest, field.change(away) / 100) << away;
  }
}

TEST(LayeredReflectivity, IsTheProductWithAllCells) {
  const auto all = fields();
  const glm::dvec3 p{0.7, 1.9, -0.4};
  EXPECT_NEAR(all[2].second->factor(p), all[0].second->factor(p) * all[1].second->factor(p), 1e-14);
  EXPECT_EQ(all[2].second->cells().size(), 5u);
}

}  // namespace
}  // namespace tubefoot
