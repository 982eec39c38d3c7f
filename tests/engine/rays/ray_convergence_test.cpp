// SPDX-License-Identifier: GPL-3.0-or-later
// Compares the ray engine with the exact engine: the rays are unbiased and converge at the theoretical
// order of each sampling. Each engine verifies the other.
#include <gtest/gtest.h>

#include <array>
#include <functional>

#include "fixtures/world/ray_pings.hpp"

namespace tubefoot {
namespace {

using Per = RaySettings::Per;

constexpr std::array<std::int64_t, 7> counts{1000, 2154, 4642, 10000, 21544, 46416, 100000};

/// Least-squares slope of log error against log number of rays.
double order(const std::function<double(std::int64_t)>& error) {
  double x = 0, y = 0, xx = 0, xy = 0;
  for (const std::int64_t n : counts) {
    const double a = std::log(double(n)), b = std::log(error(n));
    x += a;
    y += b;
    xx += a * a;
    xy += a * b;
  }
  const double m = double(counts.size());
  return (m * xy - x * y) / (m * xx - x * x);
}

TEST(RayConvergence, TheMeanOverSeedsIsTheExactEnergy) {
  const RayPing ping(rough_seabed(0.15), 3, 2, {5, 2, 10});
  ASSERT_GT(ping.total(), 0);
  for (const RaySettings& settings : {RaySettings{RaySampling::stratified, 400, Per::ping},
                                      {RaySampling::stratified, 23, Per::beam},
                                      {RaySampling::sobol, 400, Per::ping},
                                      {RaySampling::sobol, 23, Per::beam},
                                      {RaySampling::random, 400, Per::ping},
                                      {RaySampling::random, 23, Per::beam}}) {
    std::vector<Statistics> statistics(ping.exact.energy.size());
    for (std::uint64_t seed = 0; seed < 2500; ++seed) {
      RaySettings own = settings;
      own.seed = seed;
      const Echo echo = ping.echo_of(own);
      for (std::size_t k = 0; k < statistics.size(); ++k) statistics[k].add(echo.energy[k]);
    }
    int lit = 0;
    for (std::size_t k = 0; k < statistics.size(); ++k) {
      // A range bin that receives less than one ray over all seeds has no statistics.
      if (ping.exact.energy[k] < 1e-3 * ping.total()) continue;
      ++lit;
      EXPECT_NEAR(statistics[k].mean(), ping.exact.energy[k], 4.5 * statistics[k].sigma_of_mean())
          << "sampling " << int(settings.sampling) << ", " << settings.rays << " rays, sample " << k;
      EXPECT_LT(statistics[k].sigma_of_mean(), 0.1 * ping.exact.energy[k]);
    }
    EXPECT_GE(lit, 12);
  }
}

TEST(RayConvergence, OrdersOnAFlatSeabed) {
  const RayPing binned(rough_seabed(0), 1, 1, {5, 0.5, 60}), whole(rough_seabed(0), 1, 1, {1, 99, 1});
  const auto of = [&](const RayPing& ping, RaySampling sampling, int seeds) {
    return order([&](std::int64_t n) { return ping.error({sampling, n, Per::ping}, seeds); });
  };
  const double random = of(binned, RaySampling::random, 12),
               random_whole = of(whole, RaySampling::random, 150);
  const double stratified = of(binned, RaySampling::stratified, 12),
               stratified_whole = of(whole, RaySampling::stratified, 150);
  const double regular = of(binned, RaySampling::regular, 1);
  EXPECT_NEAR(random, -0.5, 0.05);
  EXPECT_NEAR(random_whole, -0.5, 0.1);
  EXPECT_NEAR(stratified, -0.75, 0.06);    // borders of range bins are discontinuities of the integrand
  EXPECT_NEAR(stratified_whole, -1, 0.1);  // without borders the integrand is smooth
  EXPECT_NEAR(regular, -0.75, 0.2);        // not random: the order varies
}

TEST(RayConvergence, SobolRaysMeetStraightBordersMoreEvenly) {
  const RayPing binned(rough_seabed(0), 8, 1, {5, 0.1, 300}), whole(rough_seabed(0), 1, 1, {1, 99, 1}),
      rough(rough_seabed(0.15), 8, 1, {5, 0.1, 300});
  const auto ratio = [](const RayPing& ping, std::int64_t rays) {
    return ping.error({RaySampling::sobol, rays, Per::beam}, 8) /
           ping.error({RaySampling::stratified, rays, Per::beam}, 8);
  };
  EXPECT_LT(ratio(binned, 1024), 0.6);
  EXPECT_LT(ratio(binned, 4096), 0.6);
  EXPECT_LT(ratio(rough, 1024), 0.95);  // borders at every angle
  // For a smooth integrand the error falls as N^-3/2 by Owen's theorem, against N^-1 for one ray per cell.
  const double few = whole.error({RaySampling::sobol, 64, Per::beam}, 60),
               many = whole.error({RaySampling::sobol, 4096, Per::beam}, 60);
  EXPECT_NEAR(std::log(many / few) / std::log(64.0), -1.5, 0.25);
}

TEST(RayConvergence, OrdersOnATerrain) {
  const RayPing ping(rough_seabed(0.15), 3, 2, {5, 0.5, 60});
  const auto of = [&](RaySampling sampling, int seeds) {
    return order([&](std::int64_t n) { return ping.error({sampling, n, Per::ping}, seeds); });
  };
  const double random = of(RaySampling::random, 12), stratified = of(RaySampling::stratified, 12),
               regular = of(RaySampling::regular, 1);
  EXPECT_NEAR(random, -0.5, 0.05);
  EXPECT_NEAR(stratified, -0.75, 0.1);
  EXPECT_NEAR(regular, -0.75, 0.2);
}

TEST(RayConvergence, AColumnKeepsItsOwnError) {
  const RayPing ping(rough_seabed(0.15), 3, 2, {5, 0.5, 60});
  const double some = ping.error({RaySampling::column, 1500, Per::beam}, 1),
               many = ping.error({RaySampling::column, 17000, Per::beam}, 1);
  EXPECT_GT(many, 0.7 * some);
  EXPECT_GT(many, 10 * ping.error({RaySampling::stratified, 17000, Per::beam}, 1));
  EXPECT_LT(many, 1);
}

}  // namespace
}  // namespace tubefoot
