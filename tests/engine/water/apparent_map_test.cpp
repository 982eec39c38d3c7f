// SPDX-License-Identifier: GPL-3.0-or-later
// Tests `ApparentMap`: it keeps direction and travel time, its facet factors conserve the energy of curved
// tubes, and it reports shadows and crossings.

#include "engine/water/apparent_map.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <random>

namespace tubefoot {
namespace {

TEST(ApparentMap, IsovelocityWaterLeavesPointsWhereTheyAre) {
  const WaterColumn water{SoundSpeedProfile({{0, 1480}, {20, 1480}}), {}};
  const ApparentMap straight(water, {3, -4, 10}, 12);
  const unsigned seed = 5;
  SCOPED_TRACE(seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> any(-100, 100);
  for (int i = 0; i < 100; ++i) {
    const glm::dvec3 x(any(random), any(random), any(random) - 90);
    const auto image = straight.apparent(x);
    ASSERT_TRUE(image);
    EXPECT_LT(glm::length(image->at_m - x), 1e-11);
    EXPECT_EQ(image->eigenrays, 1);
    const glm::dvec3 direction = glm::normalize(x - glm::dvec3(3, -4, 10));
    EXPECT_LT(glm::length(straight.arrival_direction(x, image->ray) - direction), 1e-12);
  }
  const auto below = straight.apparent({3, -4, -30});
  EXPECT_LT(glm::length(below->at_m - glm::dvec3(3, -4, -30)), 1e-13);
  EXPECT_LT(glm::length(straight.arrival_direction({3, -4, -30}, below->ray) - glm::dvec3(0, 0, -1)), 1e-14);
}

TEST(ApparentMap, KeepsDirectionAndTime) {
  const WaterColumn water{SoundSpeedProfile({{0, 1520}, {30, 1490}, {60, 1495}}), {}};
  const glm::dvec3 apex(0, 0, -5);
  const ApparentMap straight(water, apex, 0);
  const glm::dvec3 x(90, 120, -50);
  const auto image = straight.apparent(x);
  ASSERT_TRUE(image);
  const auto ray = EigenrayFinder(water, 5).direct(50, 150);
  const glm::dvec3 seen = image->at_m - apex;
  EXPECT_NEAR(glm::length(seen), 1515 * ray->time_s, 1e-11);
  EXPECT_NEAR(seen.x / seen.y, 90. / 120, 1e-14);
  EXPECT_NEAR(-seen.z / glm::length(seen), ray->launch_sine, 1e-14);
  EXPECT_NE(seen.z, x.z - apex.z);
}

TEST(ApparentMap, GapOfAnEdgeIsOfSecondOrder) {
  const WaterColumn water{SoundSpeedProfile({{0, 1520}, {30, 1490}, {60, 1495}}), {}};
  const ApparentMap straight(water, {0, 0, -5}, 0);
  const auto at = [&](glm::dvec3 x) { return straight.apparent(x)->at_m; };
  double before = 0;
  for (double length = 16; length > 0.2; length /= 2) {
    const glm::dvec3 a(80, 30, -50), b = a + length * glm::normalize(glm::dvec3(3, 1, 0.2));
    const double gap = edge_travel_path_error_m(at(a), at(b), at((a + b) / 2.0));
    if (before > 0) {
      EXPECT_NEAR(before / gap, 4, 0.35) << length;
    }
    before = gap;
  }
  EXPECT_LT(before, 1e-4);
}

/// Returns the factor of a facet with Lambert's law.
std::optional<double> factor_of(const ApparentMap& straight, const glm::dvec3 (&corners)[3],
                                double absorption_db_per_m) {
  glm::dvec3 seen[3];
  CornerReturn returns[3];
  const glm::dvec3 centre = (corners[0] + corners[1] + corners[2]) / 3.0;
  const auto middle = straight.apparent(centre);
  if (!middle) return {};
  const CornerReturn between = corner_return(straight, centre, *middle, absorption_db_per_m);
  for (int i = 0; i < 3; ++i) {
    const auto image = straight.apparent(corners[i]);
    if (!image) return {};
    seen[i] = image->at_m - straight.apex_m();
    returns[i] = corner_return(straight, corners[i], *image, absorption_db_per_m);
  }
  return facet_factor(corners, seen, returns, &between, absorption_db_per_m, lambert_sigma);
}

TEST(ApparentMap, FacetFactorIsOneInIsovelocityWater) {
  const WaterColumn water{SoundSpeedProfile({{0, 1480}, {20, 1480}}), {0.06, 0.06, 0.06}};
  const ApparentMap straight(water, {0, 0, -3}, 0);
  const glm::dvec3 facet[3] = {{30, 1, -40}, {31, 1, -40}, {30, 2, -39.5}};
  EXPECT_NEAR(*factor_of(straight, facet, 0.06), 1, 1e-12);
}

// The energy of a small facet follows from the tube of rays that it intercepts. The launch directions to
// its corners enclose its solid angle, for any formula of area per steradian.
TEST(ApparentMap, FacetFactorReturnsTheEnergyOfTheCurvedTubes) {
  const WaterColumn water{SoundSpeedProfile({{0, 1530}, {30, 1480}, {60, 1500}}), {0.05, 0.06, 0.04, 0.04}};
  const glm::dvec3 apex(0, 0, -5);
  const ApparentMap straight(water, apex, 0);
  const double absorption = 0.06;
  const glm::dvec3 a(150, 40, -52), u(0.02, 0.003, 0.004), v(-0.004, 0.02, 0.001);
  const glm::dvec3 corners[3] = {a, a + u, a + v};
  glm::dvec3 seen[3], launch[3];
  for (int i = 0; i < 3; ++i) {
    seen[i] = straight.apparent(corners[i])->at_m;
    launch[i] = glm::normalize(seen[i] - apex);
  }
  const double solid_angle =
      std::abs(glm::dot(glm::cross(launch[1] - launch[0], launch[2] - launch[0]), launch[0])) / 2;
  const glm::dvec3 centre = (corners[0] + corners[1] + corners[2]) / 3.0;
  const auto ray = straight.apparent(centre)->ray;
  // The eigenray from the facet back to the sonar comes from a separate search.
  const auto back = EigenrayFinder(water, -centre.z).direct(5, std::hypot(centre.x, centre.y));
  const glm::dvec3 n = glm::normalize(glm::cross(u, v));
  const double sine = std::abs(glm::dot(n, straight.arrival_direction(centre, ray)));
  const double energy =
      solid_angle * sine / back->tube_area_m2_per_sr * std::pow(10, -2 * back->absorption_db / 10);
  // The straight law over the apparent facet.
  const glm::dvec3 area2 = glm::cross(seen[1] - seen[0], seen[2] - seen[0]);
  const glm::dvec3 middle = (seen[0] + seen[1] + seen[2]) / 3.0 - apex;
  const double r = glm::length(middle), area = glm::length(area2) / 2;
  const double sine_seen = std::abs(glm::dot(glm::normalize(area2), middle)) / r;
  const double straight_model =
      sine_seen * sine_seen * area / std::pow(r, 4) * std::pow(10, -2 * absorption * r / 10);
  const double factor = *factor_of(straight, corners, absorption);
  EXPECT_NEAR(factor * straight_model / energy, 1, 2e-3);
  EXPECT_GT(std::abs(factor - 1), 0.02);
}

TEST(ApparentMap, TellsShadowsAndCrossings) {
  const WaterColumn parting{SoundSpeedProfile({{0, 1495}, {50, 1500}, {100, 1495}}), {}};
  const ApparentMap straight(parting, {0, 0, -40}, 0);
  EXPECT_TRUE(straight.apparent({100, 0, -60}));
  EXPECT_FALSE(straight.apparent({0, 20000, -60}));
  const glm::dvec3 facet[3] = {{20000, 0, -60}, {20001, 0, -60}, {20000, 1, -60}};
  EXPECT_FALSE(factor_of(straight, facet, 0));
  const WaterColumn crossing{SoundSpeedProfile({{0, 1500}, {100, 1500.5}, {200, 1540}}), {}};
  EXPECT_GE(ApparentMap(crossing, {0, 0, -20}, 0).apparent({3000, 0, -20})->eigenrays, 2);
  EXPECT_THROW(ApparentMap(crossing, {0, 0, 1}, 0), std::invalid_argument);
}

// A sonar that rises keeps one reference speed for its ranges. Apparent positions move towards or away from
// the sonar, and the energies of facets stay the same.
TEST(ApparentMap, ReferenceSpeedScalesImagesAndNotEnergies) {
  const WaterColumn water{SoundSpeedProfile({{0, 1520}, {40, 1480}}), {}};
  const glm::dvec3 apex(1, 2, -3);
  const ApparentMap own(water, apex, 0), other(water, apex, 0, {}, 1400);
  EXPECT_EQ(own.reference_speed_m_s(), 1517);
  const glm::dvec3 corners[3] = {{60, 5, -30}, {60.1, 5, -30}, {60, 5.1, -30}};
  glm::dvec3 seen[2][3];
  for (int i = 0; i < 3; ++i) {
    seen[0][i] = own.apparent(corners[i])->at_m - apex;
    seen[1][i] = other.apparent(corners[i])->at_m - apex;
    EXPECT_NEAR(glm::distance(seen[1][i], seen[0][i] * 1400.0 / 1517.0), 0, 1e-11);
  }
  const auto straight_model = [](const glm::dvec3(&s)[3]) {  // Lambert: sine^2 area / r^4
    const glm::dvec3 n = glm::cross(s[1] - s[0], s[2] - s[0]), c = (s[0] + s[1] + s[2]) / 3.0;
    const double r = glm::length(c), sine = glm::dot(n, c) / glm::length(n) / r;
    return sine * sine * glm::length(n) / std::pow(r, 4);
  };
  EXPECT_NEAR(*factor_of(own, corners, 0) * straight_model(seen[0]) /
                  (*factor_of(other, corners, 0) * straight_model(seen[1])),
              1, 1e-9);
}

}  // namespace
}  // namespace tubefoot
