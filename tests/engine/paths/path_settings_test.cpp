// SPDX-License-Identifier: GPL-3.0-or-later
// Tests paths over mirrors with the cheaper settings: rays, fast binning and plain doubles. The comparisons
// are closed forms and the exact visible polygons.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "engine/paths/path_echo.hpp"
#include "fixtures/world/path_scenes.hpp"

namespace tubefoot {
namespace {

using namespace test;

struct Spread {
  double sum = 0, squares = 0;
  int count = 0;
  void add(double x) {
    sum += x;
    squares += x * x;
    ++count;
  }
  double mean() const { return sum / count; }
  double sigma() const { return std::sqrt(std::max(squares / count - mean() * mean(), 0.0) / (count - 1)); }
};

class PathRaysOf : public testing::TestWithParam<RaySampling> {};
INSTANTIATE_TEST_SUITE_P(Samplings, PathRaysOf,
                         testing::Values(RaySampling::stratified, RaySampling::adaptive),
                         [](const auto& given) { return std::string(name_of(given.param)); });

TEST_P(PathRaysOf, SurfaceMultiplesOfAFlatSeabedInClosedForm) {
  Setting s = under_surface(3);
  std::vector<Spread> once(30), twice(30);
  for (std::uint64_t seed = 1; seed <= 16; ++seed) {
    s.rays = RaySettings{GetParam(), 20000, RaySettings::Per::ping, seed};
    const PathEcho paths = s.run();
    EXPECT_EQ(paths.shared_pieces, 0u);
    EXPECT_GT(paths.hits, 10000u);
    for (int k = 0; k < 30; ++k) {
      once[std::size_t(k)].add(paths.by_order[2].at(0, k));
      twice[std::size_t(k)].add(paths.by_order[3].at(0, k));
    }
  }
  for (int k = 0; k < 30; ++k) {
    const double from = 26 + k, to = from + 1;
    const double by_one = 2 * 0.6 * (rings(0.01, 15, 25, to) - rings(0.01, 15, 25, from)),
                 by_both = 0.36 * pi / 2 * 0.01 * 625 * (std::pow(from, -4) - std::pow(to, -4));
    EXPECT_NEAR(once[std::size_t(k)].mean(), by_one, 6 * once[std::size_t(k)].sigma()) << k;
    EXPECT_NEAR(twice[std::size_t(k)].mean(), by_both, 6 * twice[std::size_t(k)].sigma()) << k;
    EXPECT_LT(once[std::size_t(k)].sigma(), 0.04 * by_one) << k;
    EXPECT_LT(twice[std::size_t(k)].sigma(), 0.04 * by_both) << k;
  }
}

/// A separate receiver in a channel with a rough surface and a seabed that scatters and reflects. A block
/// stands on the seabed or floats.
Setting harbour(bool apart, double block_from_m = -10, double block_to_m = -4) {
  Setting s;
  s.mesh = square_seabed(-10, 40);
  const auto box = [&](glm::dvec3 lo, glm::dvec3 hi) {
    add_quad(s.mesh, {lo.x, lo.y, lo.z}, {hi.x, lo.y, lo.z}, {hi.x, lo.y, hi.z}, {lo.x, lo.y, hi.z}, 1);
    add_quad(s.mesh, {lo.x, lo.y, hi.z}, {hi.x, lo.y, hi.z}, {hi.x, hi.y, hi.z}, {lo.x, hi.y, hi.z}, 1);
    add_quad(s.mesh, {lo.x, lo.y, lo.z}, {lo.x, lo.y, hi.z}, {lo.x, hi.y, hi.z}, {lo.x, hi.y, lo.z}, 1);
  };
  box({2, 14, block_from_m}, {8, 18, block_to_m});
  s.transmit = towards({-3, 0, -4}, {0, 16, -6}, 40, 3, 120);
  s.receive = apart ? towards({2, 0, -3}, {0, 16, -6}, 40, 2, 120) : s.transmit;
  s.samples = {10, 2, 12};
  s.mu = {0.02, 0.1};
  s.reflection = {0.3, 0.5};
  s.paths.order = 3;
  s.paths.mirrors.surface = SeaSurface{0, 0.7, 0.4};
  s.absorption_db_per_m = 0.02;
  return s;
}

/// Compares rays over many seeds with exact visible polygons, within the statistical error.
void expect_same_mean(Setting s, const PathWater* water) {
  const PathEcho exact = s.run(nullptr, water);
  std::vector<std::vector<Spread>> sampled(4, std::vector<Spread>(12));
  for (std::uint64_t seed = 1; seed <= 16; ++seed) {
    s.rays = RaySettings{RaySampling::stratified, 8000, RaySettings::Per::ping, seed};
    const PathEcho paths = s.run(nullptr, water);
    EXPECT_EQ(paths.images, exact.images);
    EXPECT_EQ(paths.arrivals, exact.arrivals);
    EXPECT_EQ(paths.shared_pieces, 0u);
    EXPECT_GT(paths.hits, 1000u);
    for (std::size_t order = 1; order <= 3; ++order)
      for (int k = 0; k < 12; ++k) sampled[order][std::size_t(k)].add(paths.by_order[order].at(0, k));
  }
  for (int k = 0; k < 12; ++k)  // no rays without scattering
    EXPECT_NEAR(sampled[1][std::size_t(k)].mean(), exact.by_order[1].at(0, k),
                1e-12 * exact.by_order[1].at(0, k));
  for (std::size_t order = 2; order <= 3; ++order) {
    const double all = total(exact.by_order[order]);
    double wide = 0, squares = 0;
    int lit = 0;
    for (int k = 0; k < 12; ++k) {
      const Spread& bin = sampled[order][std::size_t(k)];
      const double expected = exact.by_order[order].at(0, k);
      EXPECT_NEAR(bin.mean(), expected, 6 * bin.sigma() + 1e-5 * all) << "order " << order << " sample " << k;
      wide += bin.sigma();
      if (!(expected > 1e-3 * all)) continue;
      squares += std::pow((bin.mean() - expected) / bin.sigma(), 2);
      ++lit;
    }
    EXPECT_LT(wide, 0.05 * all);
    ASSERT_GE(lit, 5);
    EXPECT_LT(squares / lit, 1 + 6 * std::sqrt(2.0 / lit));
  }
}

TEST(PathRays, TheMeanOverSeedsIsWhatExactCutsGive) {
  for (const bool apart : {false, true}) {
    SCOPED_TRACE(apart ? "apart" : "in one place");
    expect_same_mean(harbour(apart), nullptr);
  }
}

// Refracted rays over the surface and the level seabed. The block only scatters, because its walls are not
// horizontal mirrors.
TEST(PathRays, TheMeanOverSeedsIsWhatExactCutsGiveInRefractingWater) {
  for (const double gradient_per_s : {-2.0, 1.5})
    for (const bool apart : {false, true}) {
      SCOPED_TRACE(fmt::format("{} / s, {}", gradient_per_s, apart ? "apart" : "in one place"));
      Setting s = harbour(apart, -9.5, -4.2);
      s.reflection = {0.3, 0};
      s.samples = {17, 1.5, 12};  // from the range where more than a corner is received
      const WaterColumn column{SoundSpeedProfile({{0, 1500}, {60, 1500 + 60 * gradient_per_s}}),
                               {0.02, 0.02, 0.02}};
      EigenrayOptions rays;
      rays.deepest_turn_m = 10;
      const PathWater water{
          column, 0, rays, 1500, {.travel_path_error_m = 0.02}, {}, WorldGrid(20, glm::dvec3(0))};
      expect_same_mean(s, &water);
      // The water is not isovelocity, so that refraction has an effect.
      const PathEcho refracted = s.run(nullptr, &water), straight = s.run();
      EXPECT_GT(std::abs(total(refracted.by_order[2]) / total(straight.by_order[2]) - 1), 1e-3);
    }
}

TEST(PathRays, RaysGoToTheirOwnFansAndPatternsAreTakenAtTheTrueDirections) {
  Setting s = under_surface(3);
  const Directivity tilted{Directivity::Kind::gaussian, {0, 0, 1}, true, 0, 1.5};
  BeamPatterns patterns{{tilted}, {Directivity()}, {}, {}};
  patterns.fan_of_tube.assign(s.receive.tubes.size(), 0);
  patterns.beams_of_tube.assign(s.receive.tubes.size(), {0, 1});
  const PathEcho exact = s.run(&patterns);
  s.rays = RaySettings{RaySampling::stratified, 200000, RaySettings::Per::ping, 1};
  const PathEcho paths = s.run(&patterns);
  for (std::size_t order = 2; order <= 3; ++order)
    for (int k = 0; k < 30; k += 3)
      EXPECT_NEAR(paths.by_order[order].at(0, k), exact.by_order[order].at(0, k),
                  0.05 * exact.by_order[order].at(0, k))
          << order << ' ' << k;
}

TEST(PathBinning, FastBinningsOfPathsApproachExactCuts) {
  std::vector<double> errors;
  for (const int cells : {8, 32}) {
    Setting s = under_surface(3);
    s.transmit = s.receive = around({0, 0, -5}, -88, 88, cells, 120, cells);
    s.samples = {26, 4, 6};
    const PathEcho exact = s.run();
    for (const Binning binning : {Binning::spread, Binning::centroid}) {
      s.paths.binning = binning;
      const PathEcho fast = s.run();
      double difference = 0, all = 0;
      for (std::size_t order = 2; order <= 3; ++order)
        for (int k = 0; k < 6; ++k) {
          difference += std::abs(fast.by_order[order].at(0, k) - exact.by_order[order].at(0, k));
          all += exact.by_order[order].at(0, k);
        }
      errors.push_back(difference / all);
    }
  }
  EXPECT_GT(errors[0], 0.02);  // the option has an effect
  EXPECT_LT(errors[2], 0.3 * errors[0]);
  EXPECT_LT(errors[3], 0.5 * errors[1]);
  EXPECT_LT(errors[2], 0.05);
}

/// The scene is rotated and tilted, so that nothing is aligned.
Setting askew(bool apart) {
  Setting s = harbour(apart, -9.3, -4.2);
  for (GridPoint& p : s.mesh.vertices) {
    const glm::dvec3 q = metres(p);
    const double c = std::cos(0.123), d = std::sin(0.123);
    p = at({c * q.x - d * q.y, d * q.x + c * q.y, q.z + 0.0137 * q.x + 0.0071 * q.y});
  }
  return s;
}

TEST(PathDoubles, SeeTheSameWhereNothingIsDegenerate) {
  for (const bool apart : {false, true})
    for (const int scatterings : {1, 2}) {
      SCOPED_TRACE(testing::Message()
                   << (apart ? "apart, " : "in one place, ") << scatterings << " scatterings");
      Setting s = askew(apart);
      s.paths.scatterings = scatterings;
      s.paths.patch_m = 4;
      const PathEcho exact = s.run();
      s.options.arithmetic = Arithmetic::plain_double;
      s.options.tolerance =
          scatterings == 1 ? 0 : 1e-14;  // a patch sees the neighbours of its own facet edge-on
      const PathEcho plain = s.run();
      EXPECT_EQ(plain.images, exact.images);
      EXPECT_EQ(plain.arrivals, exact.arrivals);
      EXPECT_EQ(plain.patches, exact.patches);
      for (std::size_t order = 1; order <= 3; ++order) {
        const double all = total(exact.by_order[order]);
        if (order > 1) {
          EXPECT_GT(all, 0);
        }
        for (int k = 0; k < 12; ++k)
          EXPECT_NEAR(plain.by_order[order].at(0, k), exact.by_order[order].at(0, k), 1e-12 * all)
              << "order " << order << " sample " << k;
      }
    }
}

// A block on the seabed whose top has the depth of the sonar.
TEST(PathDoubles, InADegenerateSceneTheyStayFinite) {
  for (const double tolerance : {0.0, 1e-14, 1e-9}) {
    Setting s = harbour(true);
    s.paths.scatterings = 2;
    s.paths.patch_m = 4;
    const PathEcho exact = s.run();
    s.options.arithmetic = Arithmetic::plain_double;
    s.options.tolerance = tolerance;
    const PathEcho plain = s.run();
    for (std::size_t order = 2; order <= 3; ++order)
      EXPECT_NEAR(total(plain.by_order[order]), total(exact.by_order[order]),
                  0.05 * total(exact.by_order[order]))
          << order;
  }
}

}  // namespace
}  // namespace tubefoot
