// SPDX-License-Identifier: GPL-3.0-or-later
// Tests view bounds of tubes in stratified water. The comparison is rays: the bounds contain each point
// that a ray of the tubes reaches, and not many other points.
#include "engine/surface/view_bounds.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <random>

#include "engine/water/apparent_map.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

constexpr double unit_m = 0x1p-20, apex_depth_m = 12;

/// Source of random numbers for one test. It reports its seed when the test fails.
struct Random {
  explicit Random(unsigned seed) : engine(seed) {}
  std::mt19937_64 engine;
  double between(double a, double b) { return std::uniform_real_distribution<>(a, b)(engine); }
  glm::dvec3 direction() {
    const double z = between(-1, 1), azimuth = between(-pi, pi), across = std::sqrt(1 - z * z);
    return {across * std::cos(azimuth), across * std::sin(azimuth), z};
  }
};

WaterColumn some_water(Random& random) {
  std::vector<ProfilePoint> points;
  double speed = random.between(1450, 1540), depth_m = 0;
  for (int k = 0; k < 8; ++k) {
    points.push_back({depth_m, speed});
    depth_m += random.between(1, 10);
    speed += random.between(-15, 15);
  }
  return {SoundSpeedProfile(points), {}};
}

/// A fan in a random direction with a random rotation.
TubeSet some_tubes(Random& random) {
  AngularGrid angles;
  const double wide = random.between(0.2, 60) * degree, high = random.between(1, 60) * degree,
               middle = random.between(-30, 30) * degree;
  for (int k = 0; k <= 3; ++k) angles.azimuth_edges_rad.push_back(wide * (k / 3.0 - 0.5));
  for (int k = 0; k <= 5; ++k) angles.elevation_edges_rad.push_back(middle + high * (k / 5.0 - 0.5));
  const glm::dvec3 ahead = random.direction(), beside = glm::normalize(glm::cross(ahead, random.direction()));
  angles.frame = glm::dmat3(ahead, beside, glm::cross(ahead, beside));
  TubeSet set;
  set.reach = random.between(20, 200) / unit_m;
  append_tubes(set, angles);
  return set;
}

bool looks_along(const TubeSet& set, const glm::dvec3& direction) {
  const auto ray = [&](std::uint32_t k) { return glm::dvec3(set.rays[k].x, set.rays[k].y, set.rays[k].z); };
  for (const Tube& tube : set.tubes) {
    bool inside = true;
    for (std::size_t k = 0; k < 4; ++k)
      inside = inside && glm::dot(glm::cross(ray(tube[k]), ray(tube[(k + 1) % 4])), direction) > 0;
    if (inside) return true;
  }
  return false;
}

/// Returns whether a ray of the tubes reaches a point within their range.
bool is_seen(const TubeSet& set, const ApparentMap& apparent_map, const glm::dvec3& at_m) {
  const glm::dvec3 way = at_m - apparent_map.apex_m();
  const double range = std::hypot(way.x, way.y);
  for (const Eigenray& ray : apparent_map.finder().all(apparent_map.depth_m(at_m), range))
    if (apparent_map.reference_speed_m_s() * ray.time_s < set.reach * unit_m &&
        looks_along(set,
                    {ray.launch_cosine * way.x / range, ray.launch_cosine * way.y / range, -ray.launch_sine}))
      return true;
  return false;
}

TEST(ViewBounds, NothingIsMissingThatARayOfTheTubesLeadsTo) {
  std::size_t seen = 0;
  for (unsigned seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const WaterColumn water = some_water(random);
    const ApparentMap apparent_map(water, glm::dvec3(3, -2, -apex_depth_m), 0);
    const TubeSet tubes = some_tubes(random);
    const ViewBounds view_bounds(tubes, unit_m, apparent_map);
    for (int k = 0; k < 250; ++k) {
      glm::dvec3 at = apparent_map.apex_m() + random.between(1, 120) * random.direction();
      at.z = k % 2 == 0 ? random.between(-60, 0) : -std::abs(at.z);
      if (!is_seen(tubes, apparent_map, at)) continue;
      ++seen;
      EXPECT_TRUE(view_bounds.may_see(at, 0));
      const double radius = std::exp(random.between(-6, 5));
      EXPECT_TRUE(view_bounds.may_see(at + radius * 0.99 * random.direction(), radius));
      const glm::dvec3 size(random.between(0, 50), random.between(0, 50), random.between(0, 50));
      const glm::dvec3 lowest = at - random.between(0, 1) * size;
      EXPECT_TRUE(view_bounds.may_see_box(lowest, lowest + size));
      const glm::dvec3 b = at + radius * random.direction(), c = at + radius * random.direction();
      const double u = random.between(0, 1),
                   v = random.between(0, 1 - u) + 1e-3;  // at = u a + v b + (1 - u - v) c
      const glm::dvec3 a = (at - v * b - (1 - u - v) * c) / std::max(u, 1e-3);
      if (u > 1e-3) {
        EXPECT_TRUE(view_bounds.may_see({a, b, c}));
      }
    }
  }
  EXPECT_GT(seen, 1000u);
}

// The recursive subdivision needs this: it ends, and cuts everything visible.
TEST(ViewBounds, WhatIsTrueForAPartIsTrueForTheWhole) {
  std::size_t both = 0;
  for (unsigned seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const WaterColumn water = some_water(random);
    const ApparentMap apparent_map(water, glm::dvec3(0, 0, -apex_depth_m), 0);
    const ViewBounds view_bounds(some_tubes(random), unit_m, apparent_map);
    for (int k = 0; k < 30; ++k) {
      const glm::dvec3 centre = apparent_map.apex_m() + random.between(1, 120) * random.direction();
      const double radius = std::exp(random.between(-4, 4)), part = random.between(0.1, 0.9) * radius;
      const glm::dvec3 inside = centre + (radius - part) * 0.999 * random.direction();
      const glm::dvec3 corners[3] = {inside + part * random.direction(), inside + part * random.direction(),
                                     inside + part * random.direction()};
      if (view_bounds.may_see(inside, part)) {
        ++both;
        EXPECT_TRUE(view_bounds.may_see(centre, radius));
      }
      if (view_bounds.may_see(corners)) {
        const glm::dvec3 lowest = glm::min(glm::min(corners[0], corners[1]), corners[2]),
                         highest = glm::max(glm::max(corners[0], corners[1]), corners[2]);
        EXPECT_TRUE(view_bounds.may_see(centre, radius));
        EXPECT_TRUE(view_bounds.may_see_box(lowest, highest));
        EXPECT_TRUE(view_bounds.may_see_box(lowest - glm::dvec3(1, 0, 2), highest + glm::dvec3(0, 3, 0.5)));
      }
    }
  }
  EXPECT_GT(both, 500u);
}

// Unneeded points cost time. Under a thermocline the turning of rays is limited. The bounds take few points
// that no ray of the tubes reaches.
TEST(ViewBounds, TakesLittleMoreThanWhatIsSeen) {
  const WaterColumn water{
      SoundSpeedProfile({{0, 1527}, {6, 1519}, {8, 1508}, {10, 1499}, {13, 1494}, {35, 1490}}), {}};
  const ApparentMap apparent_map(water, glm::dvec3(0, 0, -8), 0);
  AngularGrid angles;  // a sidescan fan to one side
  for (int k = 0; k <= 1; ++k) angles.azimuth_edges_rad.push_back(0.3 * degree * (k - 0.5));
  for (int k = 0; k <= 8; ++k) angles.elevation_edges_rad.push_back((-60 + 57 * k / 8.0) * degree);
  TubeSet tubes;
  tubes.reach = 60 / unit_m;
  append_tubes(tubes, angles);
  const ViewBounds view_bounds(tubes, unit_m, apparent_map);
  const unsigned seed = 7;
  SCOPED_TRACE(seed);
  Random random(seed);
  std::size_t seen = 0, taken = 0;
  for (int k = 0; k < 20000; ++k) {
    const double azimuth = random.between(-0.5, 0.5) * degree, across = random.between(1, 70);
    const glm::dvec3 at(across * std::cos(azimuth), across * std::sin(azimuth), random.between(-30, 0));
    seen += is_seen(tubes, apparent_map, at);
    taken += view_bounds.may_see(at, 0);
  }
  EXPECT_GT(seen, 2000u);
  EXPECT_LT(double(taken), 1.15 * double(seen));
}

TEST(DirectionBox, FarthestIsTheFarthestOfItsDirections) {
  for (unsigned seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const double from = random.between(-pi, pi), wide = random.between(0, 0.95) * pi,
                 low = random.between(-pi / 2, pi / 2), high = random.between(low, pi / 2);
    DirectionBox box;
    box.from = {std::cos(from), std::sin(from)};
    box.to = {std::cos(from + wide), std::sin(from + wide)};
    box.all_round = seed % 5 == 0;
    box.low_sine = std::sin(low);
    box.low_cosine = std::cos(low);
    box.high_sine = std::sin(high);
    box.high_cosine = std::cos(high);
    const glm::dvec3 n = random.direction();
    double farthest = -1;
    constexpr int steps = 120;
    for (int i = 0; i <= steps; ++i)
      for (int k = 0; k <= steps; ++k) {
        const double azimuth = from + (box.all_round ? 2 * pi : wide) * i / steps,
                     elevation = low + (high - low) * k / steps;
        farthest = std::max(
            farthest, glm::dot(n, glm::dvec3(std::cos(elevation) * std::cos(azimuth),
                                             std::cos(elevation) * std::sin(azimuth), std::sin(elevation))));
      }
    EXPECT_GE(box.farthest_along(n), farthest - 1e-12);
    EXPECT_LE(box.farthest_along(n), farthest + 2e-3);
  }
}

}  // namespace
}  // namespace tubefoot
