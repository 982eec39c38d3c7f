// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the sampling of rays in tubes: random, regular, stratified, Sobol and column rays, their weights,
// and their counts per beam or per ping.

#include "engine/rays/ray_sampling.hpp"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <map>
#include <numeric>
#include <set>

#include "fixtures/world/ray_scenes.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

using Per = RaySettings::Per;
constexpr std::array<std::int64_t, 6> ladder{1, 11, 23, 114, 1500, 17000};

struct Ray {
  glm::dvec3 direction;
  double weight;
  std::uint32_t tube;
  auto key() const { return std::tuple(tube, direction.x, direction.y, direction.z, weight); }
};

std::vector<Ray> rays_of(const RayPlan& plan, std::int64_t first, std::int64_t end) {
  std::vector<Ray> rays;
  RaySource source(plan, first, end);
  RayPacket packet;
  while (source.next(packet))
    for (int k = 0; k < packet.count; ++k)
      rays.push_back({{packet.x[k], packet.y[k], packet.z[k]}, packet.weight[k], packet.tube[k]});
  return rays;
}

std::vector<Ray> rays_of(const TubeSet& tubes, const RaySettings& settings,
                         const std::vector<std::uint32_t>& beam_of_tube = {}) {
  const RayPlan plan(tubes, settings, beam_of_tube);
  std::vector<Ray> rays = rays_of(plan, 0, plan.rays());
  EXPECT_EQ(std::int64_t(rays.size()), plan.rays());
  return rays;
}

/// Beams of a camera that looks ahead, with `slices` x `rows` tubes each.
struct Fan {
  TubeSet tubes;
  std::vector<std::uint32_t> beam_of_tube;
  AngularGrid grid;
  Fan(int beams, int slices, int rows, double beam_deg, double height_deg, bool right_handed = true) {
    const int n = beams * slices;
    for (int k = 0; k <= n; ++k)
      grid.azimuth_edges_rad.push_back((double(k) / n - 0.5) * beams * beam_deg * degree);
    for (int k = 0; k <= rows; ++k)
      grid.elevation_edges_rad.push_back((double(k) / rows - 0.5) * height_deg * degree);
    if (!right_handed) grid.frame[1] = -grid.frame[1];
    append_tubes(tubes, grid);
    tubes.reach = 1e9;
    for (int k = 0; k < n * rows; ++k) beam_of_tube.push_back(std::uint32_t(k / (slices * rows)));
  }
  double solid_angle(std::uint32_t beam) const {
    double sum = 0;
    for (std::size_t t = 0; t < tubes.tubes.size(); ++t)
      if (beam_of_tube[t] == beam) sum += corner_solid_angle(tubes, tubes.tubes[t]);
    return sum;
  }
};

TEST(RaySampling, WeightsSumToSolidAnglesWhateverTheCount) {
  const Fan fan(3, 2, 2, 2.5, 30);
  for (const std::int64_t count : ladder)
    for (const auto sampling : {RaySampling::regular, RaySampling::random, RaySampling::column}) {
      SCOPED_TRACE(testing::Message() << count << " rays, sampling " << int(sampling));
      std::map<std::uint32_t, double> by_beam, by_tube;
      std::map<std::uint32_t, std::int64_t> number;
      for (const Ray& ray : rays_of(fan.tubes, {sampling, count, Per::beam, 3}, fan.beam_of_tube)) {
        by_tube[ray.tube] += ray.weight;
        by_beam[fan.beam_of_tube[ray.tube]] += ray.weight;
        ++number[fan.beam_of_tube[ray.tube]];
        ASSERT_NEAR(glm::length(ray.direction), 1, 1e-14);
      }
      ASSERT_EQ(by_beam.size(), 3u);
      for (const auto& [beam, weight] : by_beam) {
        EXPECT_NEAR(weight / fan.solid_angle(beam), 1, 1e-11);
        EXPECT_EQ(number[beam], sampling == RaySampling::regular ? std::max<std::int64_t>(count, 4) : count);
      }
      if (sampling != RaySampling::regular) continue;
      for (const auto& [tube, weight] : by_tube)
        EXPECT_NEAR(weight / corner_solid_angle(fan.tubes, fan.tubes.tubes[tube]), 1, 1e-11);
    }
}

TEST(RaySampling, DrawnWeightsSumToSolidAnglesOnAverage) {
  const TubeSet wide = pyramid({0, 0, 0}, {0, 0, -1}, 50 * degree, 40 * degree);
  const double exact = corner_solid_angle(wide, wide.tubes[0]);
  for (const std::int64_t count : ladder)
    for (const auto sampling : {RaySampling::stratified, RaySampling::sobol}) {
      Statistics statistics;
      for (std::uint64_t seed = 0; seed < (count < 200 ? 2000u : 60u); ++seed) {
        double sum = 0;
        for (const Ray& ray : rays_of(wide, {sampling, count, Per::ping, seed})) sum += ray.weight;
        statistics.add(sum);
      }
      EXPECT_NEAR(statistics.mean(), exact, 4.5 * statistics.sigma_of_mean()) << count;
      EXPECT_LT(statistics.sigma_of_mean(), 0.02 * exact) << count;
    }
}

/// Returns (u, v) of a direction in a pyramid of half angles (w, h). The corner rays have equal lengths, so
/// that the patch is a flat rectangle.
std::array<double, 2> place(glm::dvec3 d, double w, double h) {
  return {(d.x / -d.z / std::tan(w) + 1) / 2, (d.y / -d.z / std::tan(h) + 1) / 2};
}

TEST(RaySampling, RegularRaysAreTheMiddlesOfCells) {
  const double w = 30 * degree;
  const TubeSet tubes = pyramid({0, 0, 0}, {0, 0, -1}, w, w);
  std::set<std::pair<int, int>> cells;
  for (const Ray& ray : rays_of(tubes, {RaySampling::regular, 16})) {
    const auto [u, v] = place(ray.direction, w, w);
    const double i = 4 * u - 0.5, j = 4 * v - 0.5;
    EXPECT_NEAR(i, std::round(i), 1e-8);
    EXPECT_NEAR(j, std::round(j), 1e-8);
    cells.insert({int(std::round(i)), int(std::round(j))});
  }
  EXPECT_EQ(cells.size(), 16u);
  EXPECT_EQ(*cells.begin(), std::pair(0, 0));
  EXPECT_EQ(*cells.rbegin(), std::pair(3, 3));
}

TEST(RaySampling, EveryCellHasOneStratifiedRay) {
  // 17 in four rows: 4, 4, 4 and 5; 130 in eleven, so that bands of four rows are cut at both ends.
  for (const int count : {1, 2, 17, 130, 1001}) {
    const double w = 20 * degree;
    const TubeSet tubes = pyramid({0, 0, 0}, {0, 0, -1}, w, w);
    const int rows = std::max(1, int(std::round(std::sqrt(count))));
    std::vector<int> begin;
    for (int r = 0; r <= rows; ++r) begin.push_back(r * count / rows);
    // The engine may start with either side of the square tube.
    const auto fits = [&](bool turned, bool mirrored) {
      std::set<std::pair<int, int>> cells;
      for (const Ray& ray : rays_of(tubes, stratified(count, 5))) {
        auto [u, v] = place(ray.direction, w, w);
        if (turned) std::swap(u, v);
        if (mirrored) v = 1 - v;
        int row = 0;
        while (row + 1 < rows && v * count >= begin[row + 1]) ++row;
        cells.insert({row, int(u * (begin[row + 1] - begin[row]))});
      }
      return int(cells.size()) == count;
    };
    EXPECT_TRUE(fits(false, false) || fits(false, true) || fits(true, false) || fits(true, true)) << count;
  }
}

TEST(RaySampling, EveryElementaryIntervalHasOneSobolRay) {
  // Positions in (u, v) of the tube, whose patch is a rectangle. Parts of a sequence are nets as well: the
  // first 64 of 100 rays, and the next 32.
  const double w = 20 * degree, h = 7 * degree;
  const TubeSet tubes = pyramid({0, 0, 0}, {0, 0, -1}, w, h);
  for (const int count : {1, 2, 16, 64, 100, 1024})
    for (const std::uint64_t seed : {1, 2, 3}) {
      const std::vector<Ray> rays = rays_of(tubes, {RaySampling::sobol, count, Per::ping, seed});
      for (int first = 0; first < count;) {
        const int size = int(std::bit_floor(unsigned(count - first)));
        for (int columns = 1; columns <= size; columns *= 2) {
          std::set<std::pair<int, int>> cells;
          for (int k = first; k < first + size; ++k) {
            const auto [u, v] = place(rays[k].direction, h, w);
            cells.insert({int(u * columns), int(v * (size / columns))});
          }
          EXPECT_EQ(int(cells.size()), size)
              << count << " rays, from " << first << ", " << columns << " columns";
        }
        first += size;
      }
      // All rays are also the first points of one sequence: each column has one ray before any column has
      // two.
      for (const int side : {0, 1})
        for (int columns = 1; columns <= count; columns *= 2) {
          std::vector<int> in_column(columns);
          for (const Ray& ray : rays) ++in_column[int(place(ray.direction, h, w)[side] * columns)];
          for (const int number : in_column) {
            EXPECT_GE(number, count / columns);
            EXPECT_LE(number, (count + columns - 1) / columns);
          }
        }
    }
}

TEST(RaySampling, SobolRaysOfTubesAndSeedsDiffer) {
  const Fan fan(2, 1, 1, 4, 4);
  std::set<std::pair<float, float>> places;
  for (const std::uint64_t seed : {1, 2})
    for (const Ray& ray : rays_of(fan.tubes, {RaySampling::sobol, 64, Per::beam, seed}, fan.beam_of_tube)) {
      const double azimuth = std::atan2(ray.direction.y, ray.direction.x) + (ray.tube == 0 ? 0 : -4 * degree);
      places.insert({float(azimuth), float(ray.direction.z)});
    }
  EXPECT_EQ(places.size(), 256u);
}

TEST(RaySampling, RaysAreTheSameHoweverThePlanIsCut) {
  const Fan fan(5, 1, 2, 1.5, 40);
  for (const auto sampling : all_samplings)
    for (const std::int64_t count : {7, 300, 20000}) {
      if (sampling == RaySampling::adaptive) continue;  // see adaptive_rays_test.cpp
      const RayPlan plan(fan.tubes, {sampling, count, Per::ping, 9}, fan.beam_of_tube);
      std::vector<Ray> whole = rays_of(plan, 0, plan.rays()), cut;
      for (std::int64_t first = 0; first < plan.rays(); first += 7)
        for (const Ray& ray : rays_of(plan, first, std::min(first + 7, plan.rays()))) cut.push_back(ray);
      ASSERT_EQ(whole.size(), cut.size());
      const auto by_key = [](const Ray& a, const Ray& b) { return a.key() < b.key(); };
      if (sampling == RaySampling::random) {  // random rays are sorted by position
        std::sort(whole.begin(), whole.end(), by_key);
        std::sort(cut.begin(), cut.end(), by_key);
      }
      for (std::size_t k = 0; k < whole.size(); ++k)
        ASSERT_EQ(whole[k].key(), cut[k].key()) << int(sampling) << ' ' << count << " ray " << k;
    }
}

TEST(RaySampling, RandomRaysFallIntoTubesByChance) {
  const Fan fan(2, 4, 1, 4, 20);
  const int n = 1000;
  std::vector<Statistics> in_tube(8), in_beam(2);
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    std::array<int, 8> count{};
    for (const Ray& ray : rays_of(fan.tubes, {RaySampling::random, n, Per::ping, seed})) ++count[ray.tube];
    EXPECT_EQ(std::accumulate(count.begin(), count.end(), 0), n);
    for (int t = 0; t < 8; ++t) in_tube[t].add(count[t]);
  }
  for (const Statistics& s : in_tube) {
    EXPECT_NEAR(s.mean(), n / 8.0, 4.5 * s.sigma_of_mean());
    // The counts are binomial: rays are independent, not shares.
    EXPECT_NEAR(s.sigma_of_mean() * std::sqrt(399.0), std::sqrt(n * 7 / 64.0), 1.6);
  }
}

TEST(RaySampling, AColumnIsTheBeamsMiddle) {
  for (const bool right_handed : {true, false})
    for (const auto& [slices, rows] : {std::pair(1, 1), {2, 2}, {3, 1}, {4, 3}, {1, 2}})
      for (const int count : {1, 5, 7, 11}) {
        SCOPED_TRACE(testing::Message() << slices << " slices, " << rows << " rows, " << count << " rays");
        const Fan fan(3, slices, rows, 2, 20, right_handed);
        const auto rays = rays_of(fan.tubes, {RaySampling::column, count, Per::beam}, fan.beam_of_tube);
        ASSERT_EQ(int(rays.size()), 3 * count);
        // The upper and the lower wall are planes through rays at +-10 degrees. Halfway between the rays
        // the walls lie further out (tan e' = tan e / cos(w / 2)). A column between two slices lies on such
        // a ray.
        const double slice = 2 * degree / slices;
        const double half =
            slices % 2 == 1 ? std::atan(std::tan(10 * degree) / std::cos(slice / 2)) : 10 * degree;
        std::vector<bool> found(rays.size());
        for (const Ray& ray : rays) {
          const double azimuth = std::atan2(glm::dot(ray.direction, fan.grid.frame[1]), ray.direction.x);
          const double elevation = std::asin(ray.direction.z);
          const double step = 2 * half / count;
          const int beam = int(std::lround(azimuth / (2 * degree))) + 1;
          const int k = int(std::lround((elevation + half) / step - 0.5));
          ASSERT_TRUE(beam >= 0 && beam < 3 && k >= 0 && k < count);
          // Integer rays are accurate to 1e-9.
          EXPECT_NEAR(azimuth, (beam - 1) * 2 * degree, 3e-9);
          EXPECT_NEAR(elevation, -half + (k + 0.5) * step, 3e-9);
          EXPECT_EQ(fan.beam_of_tube[ray.tube], std::uint32_t(beam));
          // The solid angle is that between cones of constant elevation. Tubes have planes there, at a
          // relative distance of w^2 / 8 of the tangent.
          const double between =
              2 * degree * (std::sin(elevation + step / 2) - std::sin(elevation - step / 2));
          EXPECT_NEAR(ray.weight / between, 1, 5e-4);
          found[std::size_t(beam * count + k)] = true;
        }
        EXPECT_EQ(std::count(found.begin(), found.end(), true), 3 * count);
      }
}

TEST(RaySampling, AColumnRunsAlongTheLongerSideOfAFan) {
  // A sidescan fan: 24 slices of the depression angle (the azimuth of the grid), half a degree across.
  Fan fan(1, 24, 1, 36, 0.5);
  const auto rays = rays_of(fan.tubes, {RaySampling::column, 11, Per::beam}, fan.beam_of_tube);
  ASSERT_EQ(rays.size(), 11u);
  for (int k = 0; k < 11; ++k) {
    const double azimuth = std::atan2(rays[k].direction.y, rays[k].direction.x);
    EXPECT_NEAR(rays[k].direction.z, 0, 3e-9);
    EXPECT_NEAR(azimuth, (-18 + 36 * (k + 0.5) / 11) * degree, 3e-9);
    EXPECT_NEAR(rays[k].weight, 36 * degree / 11 * 2 * std::sin(0.25 * degree), 1e-4 * rays[k].weight);
  }
}

TEST(RaySampling, CountsByPingAreSharedOutBySolidAngle) {
  Fan fan(4, 1, 1, 1, 20);
  fan.beam_of_tube = {0, 0, 0, 1};  // three slices against one
  std::map<std::uint32_t, int> number;
  for (const Ray& ray : rays_of(fan.tubes, {RaySampling::column, 4000, Per::ping}, fan.beam_of_tube))
    ++number[fan.beam_of_tube[ray.tube]];
  EXPECT_NEAR(number[0], 3000, 1);
  EXPECT_NEAR(number[1], 1000, 1);
}

TEST(RaySampling, BadSettingsAreRefused) {
  const Fan fan(2, 2, 1, 2, 20);
  const auto refused = [&](const RaySettings& settings, const std::vector<std::uint32_t>& beams) {
    try {
      RayPlan(fan.tubes, settings, beams);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string("not refused");
  };
  const auto has = [](const std::string& text, const char* part) {
    return text.find(part) != std::string::npos ? testing::AssertionSuccess()
                                                : testing::AssertionFailure() << text;
  };
  EXPECT_TRUE(has(refused({RaySampling::stratified, -1}, {}), "not -1"));
  EXPECT_TRUE(has(refused({RaySampling::stratified, 5, Per::beam}, {}), "4 tubes, but 0 tubes have a beam"));
  EXPECT_TRUE(has(refused({RaySampling::column, 5}, {0, 0, 1}), "4 tubes, but 3 tubes have a beam"));
  EXPECT_TRUE(has(refused({RaySampling::column, 5}, {0, 1, 1, 0}), "grids of tubes"));
  EXPECT_TRUE(has(refused({RaySampling::column, 5}, fan.beam_of_tube), "not refused"));
  EXPECT_TRUE(has(refused({RaySampling::adaptive, 5}, {}), "depend on the hits"));
  EXPECT_THROW(ray_sampling_from_name("halton"), std::invalid_argument);
  for (const RaySampling sampling : all_samplings)
    EXPECT_EQ(ray_sampling_from_name(name_of(sampling)), sampling);
}

}  // namespace
}  // namespace tubefoot
