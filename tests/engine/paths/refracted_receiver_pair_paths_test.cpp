// SPDX-License-Identifier: GPL-3.0-or-later
// Tests a receiver pair that receives over mirrors in stratified water. The comparisons are isovelocity
// water, rays of one gradient in closed form and in steps to both receivers, and a gradient that tends to
// zero.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <optional>
#include <random>

#include "fixtures/world/receiver_pairs.hpp"
#include "fixtures/world/refracted_rays.hpp"

namespace tubefoot {
namespace {

using namespace test;

TEST(RefractedReceiverPairPaths, IsovelocityWaterIsTheStraightEngine) {
  const WaterColumn even{SoundSpeedProfile({{0, c_ref}, {60, c_ref}}), {0.02, 0.02, 0.02}};
  const PathWater water = water_of(even);
  const ReceiverBaseline receiver_pair{slanting_axis, 0.3, 40};
  for (const bool apart : {false, true}) {
    Setting s = furnished(apart);
    s.absorption_db_per_m = 0.02;
    s.paths.direct = false;
    s.paths.mirrors.surface->roughness = 0.8;
    const ReceiverPairPathEcho straight = received_by_receiver_pair(s, receiver_pair),
                               refracted = received_by_receiver_pair(s, receiver_pair, &water);
    EXPECT_EQ(refracted.arrivals, straight.arrivals);
    EXPECT_EQ(straight.arrivals, apart ? 2u : 0u);  // over the surface, to both receivers
    for (std::size_t order = apart ? 1 : 2; order < straight.by_order.size(); ++order) {
      const ReceiverPairEcho &a = straight.by_order[order], &b = refracted.by_order[order];
      const double peak = *std::ranges::max_element(a.upper_j);
      EXPECT_GT(peak, 0) << order;
      double turned = 0;
      for (std::size_t k = 0; k < a.upper_j.size(); ++k) {
        SCOPED_TRACE(testing::Message() << apart << " order " << order << " sample " << k);
        const double error = 5e-6 * std::max(a.upper_j[k], a.lower_j[k]) + 1e-8 * peak;
        EXPECT_NEAR(b.upper_j[k], a.upper_j[k], error);
        EXPECT_NEAR(b.lower_j[k], a.lower_j[k], error);
        // Ends of the visible polygons of the plate differ by the rounding to the grid, and so does the
        // phase.
        EXPECT_LT(std::abs(product(b, k) - product(a, k)), 10 * error);
        turned = std::max(turned, std::abs(product(a, k).imag()));
      }
      EXPECT_GT(turned, 0.01 * peak) << order;
    }
  }
}

// The deviation is of first order: half of the gradient moves energies and products half as far from those
// of isovelocity water.
TEST(RefractedReceiverPairPaths, AGradientThatGoesToZeroLeavesIsovelocityWater) {
  Setting s = under_surface(3);
  s.mesh = FacetMesh();
  for (double x = -40; x < 40; x += 10)
    for (double y = -40; y < 40; y += 10)
      add_quad(s.mesh, {x, y, -20}, {x + 10, y, -20}, {x + 10, y + 10, -20}, {x, y + 10, -20});
  s.receive = around({2, -3, -7}, -88, 88, 8, 120);
  s.samples = {22, 2, 6};
  const ReceiverBaseline receiver_pair{slanting_axis, 0.3, 8};
  const ReceiverPairPathEcho straight = received_by_receiver_pair(s, receiver_pair);
  const auto at = [&](double g) {
    const WaterColumn column = gradient(g, 1500 - 5 * g);
    const PathWater water = water_of(column, 1);
    return received_by_receiver_pair(s, receiver_pair, &water);
  };
  const ReceiverPairPathEcho whole = at(4e-3), half = at(2e-3), next_to_none = at(1e-9);
  for (const std::size_t order : {2, 3})
    for (const std::size_t k : {2, 3, 4}) {
      const ReceiverPairEcho& even = straight.by_order[order];
      const auto moved = [&](const ReceiverPairPathEcho& refracted) {
        return (product(refracted.by_order[order], k) - product(even, k)) / even.upper_j[k];
      };
      EXPECT_GT(std::abs(moved(whole)), 1e-6) << order << ' ' << k;
      EXPECT_LT(std::abs(moved(whole) / moved(half) - 2.0), 0.05) << order << ' ' << k;
      EXPECT_LT(std::abs(moved(next_to_none)), 1e-7) << order << ' ' << k;
    }
}

// Rays of one gradient in closed form connect points of a flat seabed to the transmitter and to both
// receivers. The comparison uses no value of the middle of the receiver pair.
TEST(RefractedReceiverPairPaths, PointsOfAFlatSeabedWithRaysToBothEnds) {
  for (const double g : {-0.6, 0.5})
    for (const bool apart : {false, true}) {
      Setting s = under_surface(3);
      s.mesh = FacetMesh();  // to one side
      add_quad(s.mesh, {0, -60, -20}, {60, -60, -20}, {60, 60, -20}, {0, 60, -20});
      if (apart) s.receive = around({2, -3, -7}, -88, 88, 8, 120);
      s.samples = {25, 4, 5};
      const ReceiverBaseline receiver_pair{slanting_axis, 0.3, 12};
      const WaterColumn column = gradient(g, 1510);
      const PathWater water = water_of(column, 2e-3);
      const ReceiverPairPathEcho paths = received_by_receiver_pair(s, receiver_pair, &water);
      const Circles circles{1510, g};
      std::array<ReceiverPairSums, 4> sums{ReceiverPairSums(s.samples), ReceiverPairSums(s.samples),
                                           ReceiverPairSums(s.samples), ReceiverPairSums(s.samples)};
      const glm::dvec3 middle = metres(s.receive.apex),
                       half = receiver_pair.baseline_m / 2 * receiver_pair.axis;
      constexpr int rings = 180, around_it = 24;
      const std::array<std::vector<double>, 2> chains{std::vector<double>{}, {0.0}};
      for (int n = 0; n < rings; ++n) {
        const double width = 56.0 / rings;
        for (int turn = 0; turn < around_it; ++turn) {
          // Each azimuth has its own rings, so that no whole ring falls into one range bin.
          const double x = (n + (turn * 7 % around_it + 0.5) / around_it) * width,
                       area = pi * x * width / around_it, angle = pi * ((turn + 0.5) / around_it - 0.5);
          const std::array<Circles::Ray, 2> tx{circles.to(x, 5, chains[0], 20),
                                               circles.to(x, 5, chains[1], 20)};
          const glm::dvec3 at_m(x * std::cos(angle), x * std::sin(angle), -20);
          for (std::size_t rx = 0; rx < 2; ++rx) {
            std::array<Circles::Ray, 2> back;
            for (std::size_t end = 0; end < 2; ++end) {
              const glm::dvec3 from = end == 0 ? middle + half : middle - half;
              back[end] = circles.to(std::hypot(at_m.x - from.x, at_m.y - from.y), -from.z, chains[rx], 20);
            }
            for (std::size_t there = rx == 0 ? 1 : 0; there < 2; ++there) {
              std::array<double, 2> energy;
              for (std::size_t end = 0; end < 2; ++end)
                energy[end] = 0.01 * area * std::pow(0.6, double(there + rx)) * std::sin(tx[there].arrival) *
                              std::sin(back[end].arrival) / (tx[there].area * back[end].area_back);
              sums[there + rx + 1].add(energy, c_ref * tx[there].t, {c_ref * back[0].t, c_ref * back[1].t},
                                       receiver_pair.wavenumber_rad_m);
            }
          }
        }
      }
      for (const std::size_t order : {2, 3}) {
        const ReceiverPairEcho& echo = paths.by_order[order];
        const double peak = *std::ranges::max_element(sums[order].upper);
        double turned = 0;
        for (std::size_t k = 1; k < 4; ++k) {
          SCOPED_TRACE(testing::Message()
                       << g << (apart ? " apart" : "") << " order " << order << " sample " << k);
          EXPECT_NEAR(echo.upper_j[k], sums[order].upper[k], 6e-3 * peak);
          EXPECT_NEAR(echo.lower_j[k], sums[order].lower[k], 6e-3 * peak);
          EXPECT_LT(std::abs(product(echo, k) - sums[order].cross[k]), 6e-3 * peak);
          turned = std::max(turned, std::abs(sums[order].cross[k].imag()));
        }
        EXPECT_GT(turned, 0.03 * peak);
      }
    }
}

// Unscattered sound arrives over surface and seabed at ends where the sound speed differs from the
// reference speed of the ranges.
TEST(RefractedReceiverPairPaths, ArrivalsHaveThePhaseOfTheirTimes) {
  Setting s;
  add_quad(s.mesh, {-2, -5, -20}, {45, -5, -20}, {45, 5, -20}, {-2, 5, -20});
  s.transmit = around({0, 0, -5}, -86, 86, 2, 180);
  s.receive = around({40, 0, -10}, -86, 86, 2, 180);
  s.samples = {15, 2, 12};
  s.mu = {1e-12};
  s.reflection = {0.25};
  s.paths.order = 2;
  s.paths.cutoff_db = 300;
  s.paths.mirrors.surface = SeaSurface{0, 0.8, 0};
  const ReceiverBaseline receiver_pair{slanting_axis, 0.3, 1000};
  const Circles circles{1470, 0.4};
  const WaterColumn column = gradient(0.4, 1470);
  const PathWater water = water_of(column, 1);
  const ReceiverPairPathEcho paths = received_by_receiver_pair(s, receiver_pair, &water);
  EXPECT_EQ(paths.arrivals, 8u);
  const glm::dvec3 middle = metres(s.receive.apex), half = receiver_pair.baseline_m / 2 * receiver_pair.axis;
  for (std::size_t order = 1; order <= 2; ++order) {
    ReceiverPairSums sums(s.samples);
    for (const bool surface_first : {true, false}) {
      std::vector<double> mirrors;
      double passes = 1;
      for (std::size_t k = 0; k < order; ++k) {
        const bool surface = (k % 2 == 0) == surface_first;
        mirrors.push_back(surface ? 0 : 20);
        passes *= surface ? 0.8 : 0.25;
      }
      std::array<double, 2> energy, way;
      for (std::size_t end = 0; end < 2; ++end) {
        const glm::dvec3 to = end == 0 ? middle + half : middle - half;
        const Circles::Ray ray = circles.to(std::hypot(to.x, to.y), 5, mirrors, -to.z);
        energy[end] = passes / ray.area;
        way[end] = c_ref * ray.t;
      }
      sums.add(energy, 0, way, receiver_pair.wavenumber_rad_m);
    }
    int met = 0;
    for (std::size_t k = 0; k < sums.upper.size(); ++k) {
      const ReceiverPairEcho& echo = paths.by_order[order];
      EXPECT_NEAR(echo.upper_j[k], sums.upper[k], 1e-6 * sums.upper[k] + 1e-14) << order << ' ' << k;
      EXPECT_NEAR(echo.lower_j[k], sums.lower[k], 1e-6 * sums.lower[k] + 1e-14) << order << ' ' << k;
      if (sums.cross[k] == 0.0) continue;
      ++met;
      EXPECT_LT(std::abs(product(echo, k) - sums.cross[k]), 1e-2 * sums.upper[k]) << order << ' ' << k;
    }
    EXPECT_GE(met, 1) << order;
  }
}

// Rays are integrated in steps through the water and reflected. Rays in closed form connect each insonified
// point to both receivers. The test also integrates these rays in steps, to find what hides them.
TEST(RefractedReceiverPairPaths, AgreeWithBruteForceRays) {
  Setting s = furnished(true);
  s.paths.direct = false;
  const double g = -1.2;
  const Circles circles{1510, g};
  const WaterColumn column = gradient(g, 1510);
  const PathWater water = water_of(column, 2e-3);
  const ReceiverBaseline receiver_pair{slanting_axis, 0.3, 3};
  const ReceiverPairPathEcho paths = received_by_receiver_pair(s, receiver_pair, &water);
  const Stepped rays{s, circles};
  const unsigned seed = 21;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> any(0, 1);
  constexpr int count = 6000;
  const double top = std::sin(86 * pi / 180), whole = 2 * pi * 2 * top;
  const glm::dvec3 apex = metres(s.transmit.apex), middle = metres(s.receive.apex),
                   half = receiver_pair.baseline_m / 2 * receiver_pair.axis;
  const auto reflected = [&](int what) {
    return what == Stepped::surface ? 0.6 : s.reflection[s.mesh.material[std::size_t(what)]];
  };
  struct Back {
    double energy = 0, way_m = 0;
  };
  /// Connects a point that a ray met to an end, over mirrors at these depths.
  const auto back_to = [&](const Stepped::Meeting& lit, glm::dvec3 end, const std::vector<double>& chain) {
    const glm::dvec3 way = lit.at - end;
    const Circles::Ray back = circles.to(std::hypot(way.x, way.y), -end.z, chain, -lit.at.z);
    double elevation = back.launch;  // up, if the leg begins so
    if (chain.empty() ? way.z < 0 : chain.front() == 15) elevation = -elevation;
    const double angle = std::atan2(way.y, way.x);
    if (std::abs(elevation) > 86 * pi / 180) return Back{};
    const auto rx = rays.follow(
        end,
        {std::cos(elevation) * std::cos(angle), std::cos(elevation) * std::sin(angle), std::sin(elevation)},
        int(chain.size()));
    if (rx.size() != chain.size() + 1 || rx.back().what != lit.what ||
        glm::distance(rx.back().at, lit.at) > 1e-3)
      return Back{};
    double passes = 1;
    for (std::size_t k = 0; k < chain.size(); ++k) {
      if ((rx[k].what == Stepped::surface) != (chain[k] == 0)) return Back{};
      passes *= reflected(rx[k].what);
    }
    const glm::dvec3 normal = rays.normal(lit.what);
    const double in = glm::dot(normal, lit.along), out = glm::dot(normal, rx.back().along);
    if (in * out <= 0) return Back{};
    return Back{passes * std::abs(out) / back.area_back, c_ref * rx.back().t};
  };
  // Sums over all range bins, and sums of the squares of each ray's contribution.
  std::array<Complex, 4> cross{};
  std::array<double, 4> upper{}, upper2{}, cross2{};
  for (int n = 0; n < count; ++n) {
    const double z = top * (2 * (n + any(random)) / count - 1), azimuth = 2 * pi * any(random);
    const double flat = std::sqrt(1 - z * z);
    const auto met = rays.follow(apex, {flat * std::cos(azimuth), flat * std::sin(azimuth), z}, 2);
    std::array<ReceiverPairSums, 4> own{ReceiverPairSums(s.samples), ReceiverPairSums(s.samples),
                                        ReceiverPairSums(s.samples), ReceiverPairSums(s.samples)};
    double passed = 1;
    for (std::size_t there = 0; there < met.size(); ++there) {
      const Stepped::Meeting& lit = met[there];
      for (const std::vector<double>& chain :
           {std::vector<double>{}, {0.0}, {15.0}, {0.0, 15.0}, {15.0, 0.0}}) {
        const std::size_t order = there + chain.size() + 1;
        if (lit.what < 0 || order < 2 || order > 3) continue;
        const Back up = back_to(lit, middle + half, chain), down = back_to(lit, middle - half, chain);
        const double sent = whole * passed * s.mu[s.mesh.material[std::size_t(lit.what)]];
        own[order].add({sent * up.energy, sent * down.energy}, c_ref * lit.t, {up.way_m, down.way_m},
                       receiver_pair.wavenumber_rad_m);
      }
      if (there + 1 < met.size()) passed *= reflected(lit.what);
    }
    for (std::size_t order = 2; order < 4; ++order) {
      double up = 0;
      Complex both = 0;
      for (std::size_t k = 0; k < own[order].upper.size(); ++k) {
        up += own[order].upper[k];
        both += own[order].cross[k];
      }
      upper[order] += up / count;
      upper2[order] += up * up / count;
      cross[order] += both / double(count);
      cross2[order] += std::norm(both) / count;
    }
  }
  for (std::size_t order = 2; order < 4; ++order) {
    double energy = 0;
    Complex both = 0;
    for (std::size_t k = 0; k < paths.by_order[order].upper_j.size(); ++k) {
      energy += paths.by_order[order].upper_j[k];
      both += product(paths.by_order[order], k);
    }
    const double error = std::sqrt((upper2[order] - upper[order] * upper[order]) / count),
                 cross_error = std::sqrt((cross2[order] - std::norm(cross[order])) / count);
    EXPECT_LT(error, 0.1 * upper[order]) << order;
    EXPECT_NEAR(energy, upper[order], 4.5 * error + 2e-3 * upper[order]) << order;
    EXPECT_LT(std::abs(both - cross[order]), 4.5 * cross_error + 2e-3 * upper[order]) << order;
    EXPECT_GT(std::abs(cross[order]), 8 * cross_error) << order;  // there is a phase to compare
  }
}

}  // namespace
}  // namespace tubefoot
