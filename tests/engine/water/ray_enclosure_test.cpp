// SPDX-License-Identifier: GPL-3.0-or-later
// Tests enclosures of rays over parts of a surface in random waters. They contain the values of single
// eigenrays, and their derivatives contain the differences of these values.
#include "engine/water/ray_enclosure.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <random>

namespace tubefoot {
namespace {

void expect_holds(const Interval& enclosure, double value, double slack, const char* what) {
  EXPECT_LE(enclosure.lo, value + slack) << what;
  EXPECT_GE(enclosure.hi, value - slack) << what;
}

WaterColumn random_shallow_water(std::mt19937_64& random, int layers) {
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<ProfilePoint> points{{0, 1480 + 40 * unit(random)}};
  for (int i = 0; i < layers; ++i)
    points.push_back({points.back().depth_m + 3 + 60 / layers * unit(random),
                      points.back().sound_speed_m_s + 20 * (unit(random) - 0.6)});
  std::vector<double> absorption;
  for (std::size_t i = 0; i < points.size() + 1; ++i) absorption.push_back(0.1 * unit(random));
  return {SoundSpeedProfile(points), absorption};
}

TEST(RayEnclosure, HoldsEveryEigenrayAndItsDerivatives) {
  constexpr std::uint64_t seed = 8;
  SCOPED_TRACE(fmt::format("seed {}", seed));
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  int enclosed[2] = {0, 0};
  for (int trial = 0; trial < 600; ++trial) {
    const WaterColumn water = random_shallow_water(random, 1 + trial % 4);
    const double surface = 5, apex_depth = 1 + 30 * unit(random);
    EigenrayOptions options;
    options.deepest_turn_m = 90;
    const ApparentMap apparent_map(water, {3, -2, surface - apex_depth}, surface, options, 1500);
    const RayEnclosure enclosure(apparent_map, options);
    const double size = std::pow(10, -4 * unit(random));
    std::array<Interval, 3> origin;
    glm::dvec3 centre;
    for (int i = 0; i < 3; ++i)
      origin[i] = centre[i] =
          (i == 2 ? 30 * unit(random) - 35 : (60 * unit(random) - 30) * (trial % 7 ? 1 : 0.01));
    const glm::dvec3 u =
        glm::normalize(glm::dvec3(unit(random) - 0.5, unit(random) - 0.5, unit(random) - 0.5));
    const glm::dvec3 v = glm::normalize(glm::cross(u, glm::dvec3(0.3, 0.5, 0.7)));
    const Interval box(-size, size);
    const auto rays = enclosure.over(origin, u, v, box, box);
    if (!rays) continue;
    const double slack = 1e-11 * glm::length(centre);
    const auto image_at = [&](double a, double b) {
      return apparent_map.apparent(apparent_map.apex_m() + centre + a * u + b * v)->at_m -
             apparent_map.apex_m();
    };
    ++enclosed[trial % 4 > 0];
    for (int k = 0; k < 4; ++k) {
      const double a = size * (2 * unit(random) - 1), b = size * (2 * unit(random) - 1);
      const glm::dvec3 at = apparent_map.apex_m() + centre + a * u + b * v;
      const auto point = apparent_map.apparent(at);
      ASSERT_TRUE(point) << trial;
      EXPECT_EQ(point->eigenrays, 1) << trial;
      const glm::dvec3 arrival = apparent_map.arrival_direction(at, point->ray);
      for (int i = 0; i < 3; ++i) expect_holds(rays->image[i].v, image_at(a, b)[i], slack, "image");
      expect_holds(rays->time_s.v, point->ray.time_s, 1e-12 * point->ray.time_s, "time");
      const double range = std::hypot(at.x - 3, at.y + 2),
                   distance = glm::distance(at, apparent_map.apex_m());
      expect_holds(rays->arrival_down_m.v, -arrival.z * distance, 1e-11 * distance, "arrival");
      expect_holds(rays->slowness_s_per_m.v, point->ray.time_s / distance, 1e-15, "slowness");
      if (range > 1e-3)
        expect_holds(rays->arrival_across.v, point->ray.arrival_cosine / range * distance,
                     1e-9 / range * distance, "cosine");
      const double area = apparent_map.return_area_m2_per_sr(at, point->ray) / (distance * distance);
      expect_holds(rays->area_ratio_per_sr.v, area, 1e-10 * area, "area");
      expect_holds(rays->absorption_db.v, point->ray.absorption_db, 1e-11, "absorption");
      // Derivatives: the mean of a derivative over a distance is a difference quotient.
      const double step = size, second = 4e-16 * glm::length(centre) * 40 / (step * step);
      const glm::dvec3 mid = image_at(0, 0), forth = image_at(step, 0), back = image_at(-step, 0),
                       left = image_at(0, step), right = image_at(0, -step);
      for (int i = 0; i < 3; ++i) {
        expect_holds(rays->image[i].a, (forth - back)[i] / (2 * step), second * step, "image by a");
        expect_holds(rays->image[i].aa, (forth + back - 2.0 * mid)[i] / (step * step), second, "by aa");
        expect_holds(rays->image[i].bb, (left + right - 2.0 * mid)[i] / (step * step), second, "by bb");
        const glm::dvec3 cross =
            image_at(step, step) - image_at(step, -step) - image_at(-step, step) + image_at(-step, -step);
        expect_holds(rays->image[i].ab, cross[i] / (4 * step * step), second, "by ab");
      }
      const auto value_at = [&](double a2, const auto& of) {
        const glm::dvec3 place = apparent_map.apex_m() + centre + a2 * u;
        return of(place, apparent_map.apparent(place)->ray);
      };
      const auto slope = [&](const auto& of) {
        return (value_at(step, of) - value_at(-step, of)) / (2 * step);
      };
      const auto area_of = [&](const glm::dvec3& p, const Eigenray& r) {
        const glm::dvec3 path = p - apparent_map.apex_m();
        return apparent_map.return_area_m2_per_sr(p, r) / glm::dot(path, path);
      };
      expect_holds(rays->area_ratio_per_sr.a, slope(area_of), 1e-12 * area / step, "area by a");
      const auto db_of = [](const glm::dvec3&, const Eigenray& r) { return r.absorption_db; };
      expect_holds(rays->absorption_db.a, slope(db_of), 1e-13 / step, "absorption by a");
    }
    // Small parts have narrow enclosures.
    if (size < 1e-3) {
      EXPECT_LT(rays->image[2].v.width(), 20 * size);
      EXPECT_LT(rays->area_ratio_per_sr.v.width() / rays->area_ratio_per_sr.v.hi, 300 * size);
    }
  }
  EXPECT_GT(enclosed[0], 50);
  EXPECT_GT(enclosed[1], 100);
}

TEST(RayEnclosure, ClaimsNothingWhereRaysAreSeveralOrNone) {
  // A duct: sound is slowest at 20 m.
  const WaterColumn water{SoundSpeedProfile({{0, 1520}, {20, 1480}, {40, 1520}}), {}};
  const EigenrayOptions options{.deepest_turn_m = 40};
  const ApparentMap apparent_map(water, {0, 0, -20}, 0, options);
  const RayEnclosure enclosure(apparent_map, options);
  const auto over = [&](double range, double below) {
    return enclosure.over({range, 0.0, -below}, {1, 0, 0}, {0, 1, 0}, {-0.01, 0.01}, {-0.01, 0.01});
  };
  EXPECT_TRUE(over(10, 15));
  EXPECT_FALSE(over(300, 5));
  ASSERT_GT(apparent_map.apparent({300, 0, -25})->eigenrays, 1);
  // The ray bends upwards before it reaches the point.
  const WaterColumn up{SoundSpeedProfile({{0, 1400}, {40, 1800}}), {}};
  const ApparentMap shadowed(up, {0, 0, -20}, 0, {.deepest_turn_m = 25});
  const RayEnclosure dark(shadowed, {.deepest_turn_m = 25});
  ASSERT_FALSE(shadowed.apparent({100, 0, -25}));
  EXPECT_FALSE(dark.over({100.0, 0.0, -5.0}, {1, 0, 0}, {0, 1, 0}, {-0.01, 0.01}, {-0.01, 0.01}));
}

TEST(RayEnclosure, IntervalsRoundOutwards) {
  const Interval third = Interval(1.0) / Interval(3.0);
  EXPECT_LT(third.lo, third.hi);
  EXPECT_TRUE((third * 3.0 - 1.0).may_be_zero());
  EXPECT_FALSE((Interval(1.0) / Interval(-1, 1)).is_finite());
  EXPECT_FALSE((Interval(0.0) * outwards(1, 0)).is_finite());
  EXPECT_EQ(squared(Interval(-2, 1)).lo, 0);
  EXPECT_GE(squared(Interval(-2, 1)).hi, 4);
}

}  // namespace
}  // namespace tubefoot
