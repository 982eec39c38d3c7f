// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the distribution of adaptive rays. The rays are unbiased: the pilot of a cell has no influence on
// the number of rays of that cell.
#include "engine/rays/adaptive_rays.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>

#include "fixtures/world/ray_pings.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

using Per = RaySettings::Per;

RaySettings adaptive(std::int64_t rays, Per per = Per::ping, std::uint64_t seed = 1) {
  return {RaySampling::adaptive, rays, per, seed};
}

const RayGuide guide{0, 1, 100};

/// Three beams of two tubes.
struct ThreeBeams {
  TubeSet tubes;
  std::vector<std::uint32_t> beam_of_tube{0, 0, 1, 1, 2, 2};
  ThreeBeams() {
    AngularGrid fan;
    for (int k = 0; k <= 6; ++k) fan.azimuth_edges_rad.push_back((k - 3) * 2 * degree);
    fan.elevation_edges_rad = {-10 * degree, 10 * degree};
    append_tubes(tubes, fan);
    tubes.reach = 1e9;
  }
};

/// Draws random echoes for the pilots of the cells.
std::vector<PilotEcho> drawn(std::int64_t cells, std::mt19937_64& random) {
  std::uniform_real_distribution<float> uniform;
  std::vector<PilotEcho> met;
  for (std::int64_t k = 0; k < cells; ++k) {
    met.push_back({100 * uniform(random), uniform(random)});
    if (uniform(random) < 0.3f) met.back() = {};
  }
  return met;
}

std::vector<std::int64_t> counts_of(const AdaptiveRays& rays) {
  std::vector<std::int64_t> counts;
  for (std::int64_t cell = 0; cell < rays.pilots(); ++cell) counts.push_back(rays.rays_in(cell));
  return counts;
}

struct WeightedRay {
  glm::dvec3 direction;
  double weight;
  std::uint32_t tube;
};

/// Returns the pilots first, each of which is one of the rays of its cell. The other rays follow, in
/// portions of `part` rays.
std::vector<WeightedRay> rays_of(const AdaptiveRays& rays, std::int64_t part, bool pilots_only = false) {
  std::vector<WeightedRay> all;
  RayPacket packet;
  for (const bool pilots : {true, false}) {
    if (pilots_only && !pilots) break;
    const std::int64_t count = pilots ? rays.pilots() : rays.others();
    for (std::int64_t first = 0; first < count; first += part) {
      AdaptiveRays::Source source(rays, pilots, first, std::min(first + part, count));
      while (source.next(packet))
        for (int k = 0; k < packet.count; ++k)
          all.push_back({{packet.x[k], packet.y[k], packet.z[k]},
                         packet.weight[k] / (pilots ? double(rays.rays_in(std::int64_t(all.size()))) : 1),
                         packet.tube[k]});
    }
  }
  return all;
}

TEST(AdaptiveRays, AsManyAsAreRequested) {
  const ThreeBeams fan;
  std::mt19937_64 random(1);
  for (const Per per : {Per::ping, Per::beam})
    for (const std::int64_t count : {1, 2, 7, 11, 23, 114, 1500, 17000}) {
      AdaptiveRays rays(fan.tubes, adaptive(count, per), fan.beam_of_tube, &guide);
      rays.deal(drawn(rays.pilots(), random));
      const std::int64_t requested =
          per == Per::ping ? std::max<std::int64_t>(count, 6) : 3 * std::max<std::int64_t>(count, 2);
      EXPECT_EQ(rays.pilots() + rays.others(), requested) << count;
      std::int64_t sum = 0;
      for (const std::int64_t in_cell : counts_of(rays)) {
        EXPECT_GE(in_cell, 1);
        sum += in_cell;
      }
      EXPECT_EQ(sum, requested);
      const std::vector<WeightedRay> whole = rays_of(rays, requested), cut = rays_of(rays, 7);
      ASSERT_EQ(std::int64_t(whole.size()), requested);
      ASSERT_EQ(cut.size(), whole.size());
      std::map<std::uint32_t, int> by_beam;
      for (std::size_t k = 0; k < whole.size(); ++k) {
        ASSERT_EQ(whole[k].direction, cut[k].direction) << k;
        ASSERT_EQ(whole[k].weight, cut[k].weight) << k;
        ASSERT_EQ(whole[k].tube, cut[k].tube) << k;
        ++by_beam[fan.beam_of_tube[whole[k].tube]];
      }
      if (per == Per::ping) continue;
      for (const auto& [beam, number] : by_beam) EXPECT_EQ(number, std::max<std::int64_t>(count, 2));
    }
}

TEST(AdaptiveRays, ACellsOwnPilotHasNoSayInItsNumber) {
  const ThreeBeams fan;
  std::mt19937_64 random(2);
  AdaptiveRays rays(fan.tubes, adaptive(600), fan.beam_of_tube, &guide);
  std::vector<PilotEcho> met = drawn(rays.pilots(), random);
  rays.deal(met);
  const std::vector<std::int64_t> before = counts_of(rays);
  int moved = 0;
  for (std::size_t cell = 0; cell < met.size(); ++cell) {
    const PilotEcho own = met[cell];
    for (const PilotEcho other : {PilotEcho{}, PilotEcho{99.5f, 50}, PilotEcho{0.5f, 0.01f}}) {
      met[cell] = other;
      rays.deal(met);
      ASSERT_EQ(rays.rays_in(std::int64_t(cell)), before[cell]) << cell;
      moved += counts_of(rays) != before;
    }
    met[cell] = own;
  }
  EXPECT_GT(moved, 100);  // but in the counts of other cells
}

TEST(AdaptiveRays, WeightsSumToSolidAnglesOnAverage) {
  const TubeSet wide = pyramid({0, 0, 0}, {0, 0, -1}, 50 * degree, 40 * degree);
  const double exact = corner_solid_angle(wide, wide.tubes[0]);
  for (const std::int64_t count : {1, 11, 114, 1500}) {
    Statistics statistics;
    for (std::uint64_t seed = 0; seed < (count < 200 ? 2000u : 60u); ++seed) {
      std::mt19937_64 random(seed);
      AdaptiveRays rays(wide, adaptive(count, Per::ping, seed), {}, &guide);
      rays.deal(drawn(rays.pilots(), random));
      double sum = 0;
      for (const WeightedRay& ray : rays_of(rays, 1000)) sum += ray.weight;
      statistics.add(sum);
    }
    EXPECT_NEAR(statistics.mean(), exact, 4.5 * statistics.sigma_of_mean()) << count;
    EXPECT_LT(statistics.sigma_of_mean(), 0.02 * exact) << count;
  }
}

TEST(AdaptiveRays, RaysOfACellAreANetThatItsPilotIsOneOf) {
  // One cell: a square tube whose patch is flat, so that (u, v) is known.
  const double w = 20 * degree;
  const TubeSet tubes = pyramid({0, 0, 0}, {0, 0, -1}, w, w);
  for (const std::uint64_t seed : {1, 2, 3}) {
    AdaptiveRays rays(tubes, adaptive(3, Per::ping, seed), {}, &guide);
    ASSERT_EQ(rays.pilots(), 1);
    AdaptiveRays alone(tubes, adaptive(1, Per::ping, seed), {}, &guide);
    rays.deal(std::vector<PilotEcho>(1));
    alone.deal(std::vector<PilotEcho>(1));
    EXPECT_EQ(rays_of(rays, 9).front().direction, rays_of(alone, 9).front().direction);
  }
  // Twenty-five cells: those with 2^k rays have one ray in each of 2^a x 2^(k - a) parts.
  std::mt19937_64 random(3);
  int nets = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    AdaptiveRays rays(tubes, adaptive(50, Per::ping, seed), {}, &guide);
    ASSERT_EQ(rays.pilots(), 25);
    rays.deal(drawn(25, random));
    std::map<std::pair<int, int>, std::vector<std::pair<double, double>>> cells;
    for (const WeightedRay& ray : rays_of(rays, 100)) {
      const double u = 2.5 * (ray.direction.x / -ray.direction.z / std::tan(w) + 1),
                   v = 2.5 * (ray.direction.y / -ray.direction.z / std::tan(w) + 1);
      cells[{int(u), int(v)}].push_back({u - std::floor(u), v - std::floor(v)});
    }
    ASSERT_EQ(cells.size(), 25u);
    for (const auto& [cell, points] : cells) {
      const auto count = points.size();
      if ((count & (count - 1)) != 0) continue;
      ++nets;
      for (std::size_t columns = 1; columns <= count; columns *= 2) {
        std::set<std::pair<int, int>> parts;
        for (const auto& [u, v] : points)
          parts.insert({int(u * double(columns)), int(v * double(count / columns))});
        EXPECT_EQ(parts.size(), count) << "seed " << seed;
      }
    }
  }
  EXPECT_GT(nets, 200);
}

TEST(AdaptiveRays, RaysGoWhereNeighboursDifferAndNoCellIsStarved) {
  const TubeSet tubes = pyramid({0, 0, 0}, {0, 0, -1}, 20 * degree, 20 * degree);
  AdaptiveRays rays(tubes, adaptive(2048), {}, &guide);
  ASSERT_EQ(rays.pilots(), 1024);
  // The echo is uniform except where half of the fan has no facet.
  std::vector<PilotEcho> met;
  const std::vector<WeightedRay> pilots = rays_of(rays, 2048, true);
  for (std::size_t k = 0; k < 1024; ++k)
    met.push_back(pilots[k].direction.x < 0 ? PilotEcho{10.5f, 1} : PilotEcho{});
  rays.deal(met);
  std::vector<std::int64_t> at_border, elsewhere;
  for (std::size_t k = 0; k < 1024; ++k)
    (std::abs(pilots[k].direction.x / pilots[k].direction.z) < std::tan(20 * degree) / 16 ? at_border
                                                                                          : elsewhere)
        .push_back(rays.rays_in(std::int64_t(k)));
  ASSERT_EQ(at_border.size(), 64u);
  EXPECT_GT(*std::min_element(at_border.begin(), at_border.end()),
            8 * *std::max_element(elsewhere.begin(), elsewhere.end()));
  EXPECT_GE(*std::min_element(elsewhere.begin(), elsewhere.end()), 1);
  // If all pilots agree, all cells get the same number of rays.
  rays.deal(std::vector<PilotEcho>(1024, PilotEcho{10.5f, 1}));
  for (const std::int64_t count : counts_of(rays)) EXPECT_EQ(count, 2);
  rays.deal(std::vector<PilotEcho>(1024));
  for (const std::int64_t count : counts_of(rays)) EXPECT_EQ(count, 2);
}

/// A step with an overhang, and posts.
FacetMesh quay() {
  FacetMesh mesh = flat_seabed(4, 60);
  add_rectangle(mesh, {-15, 9, -4}, {30, 0, 0}, {0, 0, 1.5});
  add_rectangle(mesh, {-15, 9, -2.5}, {30, 0, 0}, {0, 8, 0.5});
  add_rectangle(mesh, {-1.5, 8, -2.6}, {3, 0, 0}, {0, 1, 0.1});
  for (int k = -3; k <= 3; ++k) add_rectangle(mesh, {0.31 * k, 6 + 0.4 * k, -4}, {0.09, 0.01, 0}, {0, 0, 1});
  return mesh;
}

/// A sphere of facets over a seabed.
FacetMesh ball() {
  FacetMesh mesh = flat_seabed(4, 60);
  const int n = 12;
  const auto at = [&](int i, int j) {
    const double a = 2 * pi * i / (2 * n), b = pi * j / n;
    return glm::dvec3(0.2 + 0.8 * std::sin(b) * std::cos(a), 8 + 0.8 * std::sin(b) * std::sin(a),
                      -3 + 0.8 * std::cos(b));
  };
  for (int i = 0; i < 2 * n; ++i)
    for (int j = 0; j < n; ++j) {
      if (j > 0) add_facet(mesh, at(i, j), at(i + 1, j + 1), at(i + 1, j));
      if (j + 1 < n) add_facet(mesh, at(i, j), at(i, j + 1), at(i + 1, j + 1));
    }
  return mesh;
}

TEST(AdaptiveRays, TheMeanOverSeedsIsTheExactEnergy) {
  const RangeSamples samples{5, 1, 14};
  const RayPing scenes[] = {
      {rough_seabed(0.15), 3, 2, samples}, {quay(), 3, 1, samples}, {ball(), 3, 1, samples}};
  for (const RayPing& ping : scenes)
    for (const int kind : {0, 1, 2}) {
      RaySettings settings = kind == 1 ? adaptive(60, Per::beam) : adaptive(400);
      SCOPED_TRACE(testing::Message() << "scene " << &ping - scenes << ", kind " << kind);
      std::vector<Statistics> statistics(ping.exact.energy.size());
      Statistics total;
      for (settings.seed = 0; settings.seed < 2500; ++settings.seed) {
        const Echo echo = kind == 2 ? ping.echo_without_guide(settings) : ping.echo_of(settings);
        double sum = 0;
        for (std::size_t k = 0; k < statistics.size(); ++k) {
          statistics[k].add(echo.energy[k]);
          sum += echo.energy[k];
        }
        total.add(sum);
      }
      EXPECT_NEAR(total.mean(), ping.total(), 4 * total.sigma_of_mean());
      int lit = 0;
      double squares = 0;
      for (std::size_t k = 0; k < statistics.size(); ++k) {
        if (ping.exact.energy[k] < 3e-3 * ping.total()) continue;
        ++lit;
        const double off = (statistics[k].mean() - ping.exact.energy[k]) / statistics[k].sigma_of_mean();
        squares += off * off;
        EXPECT_LT(std::abs(off), 4.5) << "bin " << k;
        EXPECT_LT(statistics[k].sigma_of_mean(), 0.1 * ping.exact.energy[k]);
      }
      EXPECT_GE(lit, 10);
      EXPECT_LT(squares / lit, 1 + 5 * std::sqrt(2.0 / lit));  // chi squared
    }
}

TEST(AdaptiveRays, LessErrorThanStratifiedOnesWhereSamplesAreWide) {
  const RayPing scenes[] = {{rough_seabed(0), 1, 1, {5, 1, 14}}, {quay(), 1, 1, {5, 1, 14}}};
  for (const RayPing& ping : scenes)
    EXPECT_LT(ping.error(adaptive(20000), 8),
              0.8 * ping.error({RaySampling::stratified, 20000, Per::ping}, 8));
}

}  // namespace
}  // namespace tubefoot
