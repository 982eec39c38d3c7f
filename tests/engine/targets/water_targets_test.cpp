// SPDX-License-Identifier: GPL-3.0-or-later
// Tests targets in the water: which tubes and bins contain them, exact occlusion, echoes in closed form,
// tables of strengths, and populations. The oracles are closed forms, exact fractions, Poisson statistics,
// and the volume-scattering integral.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <boost/math/distributions/poisson.hpp>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <complex>
#include <limits>
#include <map>
#include <random>

#include "engine/scattering/counter_random.hpp"
#include "engine/targets/target_echo.hpp"
#include "engine/targets/target_signals.hpp"
#include "engine/targets/targets_in_tubes.hpp"
#include "fixtures/world/path_scenes.hpp"

namespace tubefoot {
namespace {

using namespace test;
using Fraction = boost::multiprecision::cpp_rational;

const WorldGrid target_grid(20, glm::dvec3(0));

GridPoint plus(GridPoint a, GridPoint b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }

// Law X1. Points on walls and on common rays are the hard cases. All tubes of a full turn cover every
// direction.
TEST(TubeWalls, ContainEachPointOnceAlsoOnWallsAndRays) {
  const unsigned seed = 11;
  SCOPED_TRACE(fmt::format("seed {}", seed));
  std::mt19937_64 random(seed);
  const TubeSet set = around({0, 0, 0}, -60, 60, 6, 40, 12);
  const TubeWalls walls(set);
  std::vector<std::uint32_t> found;
  const auto expect_one = [&](GridPoint point) {
    walls.find(point, found);
    EXPECT_EQ(found.size(), 1u) << point.x << " " << point.y << " " << point.z;
  };
  std::uniform_real_distribution<double> angle(-pi, pi), height(-0.8, 0.8);
  for (int k = 0; k < 2000; ++k) {
    const double a = angle(random), z = height(random), r = std::sqrt(1 - z * z);
    expect_one(at({10 * r * std::cos(a), 10 * r * std::sin(a), 10 * z}));
  }
  // Rays lie on the walls of four tubes. The azimuths 0, 90, 180 and 270 degrees have walls in coordinate
  // planes.
  for (const GridPoint& ray : set.rays)
    if (std::abs(ray.z) < 0.86 * (1 << 30)) expect_one(ray);
  std::uniform_int_distribution<std::int32_t> any(-(1 << 22), 1 << 22);
  for (int k = 0; k < 400; ++k) {
    const std::int32_t across = any(random), up = any(random);
    if (std::abs(up) > std::abs(across)) continue;
    expect_one(k % 2 ? GridPoint{0, across, up} : GridPoint{across, 0, up});
    expect_one(k % 2 ? GridPoint{0, across, 0} : GridPoint{across, 0, 0});
  }
  EXPECT_FALSE(walls.contains(0, set.apex));
}

// Law X2, for a facet perpendicular to the line of sight. The line through its border is blocked. The next
// grid point beside it is visible.
TEST(TargetInView, VanishesExactlyAtTheSilhouette) {
  FacetMesh mesh;
  add_quad(mesh, {-1, 4, -1}, {1, 4, -1}, {1, 4, 1}, {-1, 4, 1});
  const SceneTree tree(mesh);
  const GridPoint apex{0, 0, 0}, border = at({2, 8, 0.5});
  EXPECT_FALSE(is_target_in_view(mesh, tree, apex, border));
  EXPECT_TRUE(is_target_in_view(mesh, tree, apex, {border.x + 1, border.y, border.z}));
  EXPECT_FALSE(is_target_in_view(mesh, tree, apex, {border.x - 1, border.y, border.z}));
  EXPECT_TRUE(is_target_in_view(mesh, tree, apex, at({0, 3.5, 0}))) << "before the facet";
  EXPECT_TRUE(is_target_in_view(mesh, tree, apex, at({0, 4, 0}))) << "on the facet";
  EXPECT_FALSE(is_target_in_view(mesh, tree, apex, plus(at({0, 4, 0}), {0, 1, 0})));
}

using RationalVector = std::array<Fraction, 3>;
RationalVector rational(GridPoint p) { return {p.x, p.y, p.z}; }
RationalVector minus(const RationalVector& a, const RationalVector& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Fraction determinant(const RationalVector& a, const RationalVector& b, const RationalVector& c) {
  return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
         a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/// Whether the open segment from an apex to a target meets a triangle or its border. The point on the plane
/// has barycentric coordinates of one sign.
bool hides(const std::array<GridPoint, 3>& triangle, GridPoint apex, GridPoint target) {
  const RationalVector from = rational(apex), d = minus(rational(target), from);
  std::array<RationalVector, 3> v;
  for (std::size_t k = 0; k < 3; ++k) v[k] = minus(rational(triangle[k]), from);
  const Fraction volume = determinant(v[0], v[1], v[2]);
  if (volume == 0) return false;
  const std::array<Fraction, 3> weight{determinant(d, v[1], v[2]) / volume,
                                       determinant(v[0], d, v[2]) / volume,
                                       determinant(v[0], v[1], d) / volume};
  // d is the sum of weight times corner. It reaches the plane at the reciprocal of the sum of weights.
  return weight[0] >= 0 && weight[1] >= 0 && weight[2] >= 0 && weight[0] + weight[1] + weight[2] > 1;
}

// Law X2. Small coordinates make lines through borders and corners frequent.
TEST(TargetInView, IsTheResultOfRationalArithmetic) {
  const unsigned seed = 3;
  SCOPED_TRACE(fmt::format("seed {}", seed));
  std::mt19937_64 random(seed);
  std::uniform_int_distribution<std::int32_t> any(-4, 4);
  const auto point = [&] { return GridPoint{any(random), any(random), any(random)}; };
  std::array<std::size_t, 2> results{};
  for (int scene = 0; scene < 300; ++scene) {
    FacetMesh mesh;
    std::vector<std::array<GridPoint, 3>> triangles;
    for (int k = 0; k < 3; ++k) {
      triangles.push_back({point(), point(), point()});
      const auto& t = triangles.back();
      const VertexId a = add_vertex(mesh, t[0]), b = add_vertex(mesh, t[1]), c = add_vertex(mesh, t[2]);
      add_facet(mesh, a, b, c);
    }
    const SceneTree tree(mesh);
    for (int k = 0; k < 20; ++k) {
      const GridPoint apex = point(), target = point();
      if (apex == target) continue;
      const bool hidden =
          std::ranges::any_of(triangles, [&](const auto& t) { return hides(t, apex, target); });
      EXPECT_EQ(is_target_in_view(mesh, tree, apex, target), !hidden) << "scene " << scene;
      ++results[hidden ? 1 : 0];
    }
  }
  EXPECT_GT(results[0], 500u);
  EXPECT_GT(results[1], 300u);
}

TEST(TargetBins, CompareTheSquaresExactly) {
  const unsigned seed = 5;
  SCOPED_TRACE(fmt::format("seed {}", seed));
  std::mt19937_64 random(seed);
  std::uniform_int_distribution<std::int32_t> any(-(1 << 24), 1 << 24);
  std::size_t wrong_by_rounding = 0;
  for (int k = 0; k < 3000; ++k) {
    const GridPoint apex{any(random), any(random), any(random)};
    const GridPoint target{any(random), any(random), any(random)};
    const double range_m = glm::length(glm::dvec3(double(target.x) - apex.x, double(target.y) - apex.y,
                                                  double(target.z) - apex.z)) *
                           unit;
    // A border at the rounded range, or next to it.
    double border_m = range_m;
    for (int step = 0; step < k % 3; ++step) border_m = std::nextafter(border_m, k % 2 ? 100.0 : 0.0);
    const SampleFinder samples(RangeSamples{border_m, 1, 2});
    const Fraction dx = std::int64_t(target.x) - apex.x, dy = std::int64_t(target.y) - apex.y,
                   dz = std::int64_t(target.z) - apex.z;
    const Fraction square = (dx * dx + dy * dy + dz * dz) * Fraction(unit) * Fraction(unit);
    const bool inside = square >= Fraction(border_m) * Fraction(border_m);
    wrong_by_rounding += inside != (range_m >= border_m);
    const auto bins = bin_of_range(samples, apex, target, unit);
    EXPECT_EQ(bins.has_value(), inside);
    if (bins) {
      EXPECT_EQ(*bins, (TargetBins{0, 1, true}));
    }
  }
  // The rounded range is on the wrong side of many borders, so that only exact comparison gives these bins.
  EXPECT_GT(wrong_by_rounding, 200u);
  // A range of exactly 5 m lies on the border of two bins, and belongs to the farther one.
  const SampleFinder metres_of(RangeSamples{4, 1, 3});
  EXPECT_EQ(bin_of_range(metres_of, at({0, 0, 0}), at({3, 4, 0}), unit), (TargetBins{1, 2, true}));
  EXPECT_EQ(bin_of_range(metres_of, at({0, 0, 0}), plus(at({3, 4, 0}), {-1, 0, 0}), unit),
            (TargetBins{0, 1, true}));
  EXPECT_FALSE(bin_of_range(metres_of, at({0, 0, 0}), at({7, 0, 0}), unit));
}

TEST(TargetBins, AnUncertainHalfPathMayLieInEachBin) {
  const SampleFinder samples(RangeSamples{4, 1, 3});
  EXPECT_EQ(bin_of_half_path(samples, Interval(4.5, 4.6)), (TargetBins{0, 1, true}));
  EXPECT_EQ(bin_of_half_path(samples, Interval(4.9, 5.1)), (TargetBins{0, 2, false}));
  EXPECT_EQ(bin_of_half_path(samples, Interval(3.9, 4.1)), (TargetBins{0, 1, false}));
  EXPECT_EQ(bin_of_half_path(samples, Interval(6.9, 7.1)), (TargetBins{2, 3, false}));
  EXPECT_FALSE(bin_of_half_path(samples, Interval(3.8, 3.9)));
  EXPECT_FALSE(bin_of_half_path(samples, Interval(7, 7.1)));
}

// The true half path h solves h = half path at the receiver position of the time 2 h / c. The interval that
// contains it receives the target. By the position in the middle of the interval, targets next to a border
// would be lost or counted twice.
TEST(TargetBins, OneIntervalOfAMovingReceiverContainsATarget) {
  const unsigned seed = 8;
  SCOPED_TRACE(fmt::format("seed {}", seed));
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> any(-12, 12);
  constexpr double speed_of_sound = 1500;
  constexpr int in_interval = 4;
  const glm::dvec3 speed(5, 25, -3);
  const RangeSamples all{4, 0.25, 64};
  std::size_t inside = 0, wrong_by_middle = 0;
  for (int repeat = 0; repeat < 20000; ++repeat) {
    const glm::dvec3 target(any(random), any(random), any(random));
    const auto half_path = [&](double received_m) {
      const glm::dvec3 receiver = speed * (2 * received_m / speed_of_sound);
      return (glm::length(target) + glm::distance(target, receiver)) / 2;
    };
    int count = 0, count_by_middle = 0, bin = 0;
    for (int first = 0; first < all.count; first += in_interval) {
      const double begin_m = all.border_m(first), end_m = all.border_m(first + in_interval);
      const SampleFinder samples(RangeSamples{begin_m, all.step_m, in_interval});
      const double at_begin = half_path(begin_m), at_middle = half_path((begin_m + end_m) / 2),
                   at_end = half_path(end_m);
      const auto bins =
          bin_of_moving_receiver(samples, end_m, MovingHalfPaths<double>{at_begin, at_middle, at_end});
      EXPECT_EQ(bins, bin_of_moving_receiver(samples, end_m,
                                             MovingHalfPaths<Interval>{at_begin, at_middle, at_end}));
      count_by_middle += bin_of_half_path(samples, at_middle).has_value();
      if (!bins) continue;
      ++count;
      bin = first + static_cast<int>(bins->first);
    }
    double true_m = glm::length(target);
    for (int step = 0; step < 40; ++step) true_m = half_path(true_m);
    const bool is_inside = true_m >= all.first_m && true_m < all.border_m(all.count);
    EXPECT_EQ(count, is_inside ? 1 : 0) << true_m;
    if (count == 1) {
      EXPECT_NEAR(bin + 0.5, (true_m - all.first_m) / all.step_m, 0.6);
    }
    inside += is_inside;
    wrong_by_middle += count_by_middle != (is_inside ? 1 : 0);
  }
  EXPECT_GT(inside, 10000u);
  EXPECT_GT(wrong_by_middle, 50u);
}

TEST(TargetBins, AnUncertainBorderOfAnIntervalLeavesTheTargetUncertain) {
  const SampleFinder samples(RangeSamples{4, 1, 3});
  using HalfPaths = MovingHalfPaths<Interval>;
  EXPECT_EQ(bin_of_moving_receiver(samples, 7, HalfPaths{{4.0, 4.1}, {4.2, 4.3}, {4.3, 4.4}}),
            (TargetBins{0, 1, true}));
  EXPECT_EQ(bin_of_moving_receiver(samples, 7, HalfPaths{{3.9, 4.1}, {3.8, 3.9}, {3.7, 3.8}}),
            (TargetBins{0, 1, false}));
  EXPECT_EQ(bin_of_moving_receiver(samples, 7, HalfPaths{{6.9, 7}, {7, 7.1}, {6.9, 7}}),
            (TargetBins{2, 3, false}));
  EXPECT_FALSE(bin_of_moving_receiver(samples, 7, HalfPaths{{3.8, 3.9}, {4.1, 4.2}, {4.2, 4.3}}));
  EXPECT_FALSE(bin_of_moving_receiver(samples, 7, HalfPaths{{6.8, 6.9}, {6.8, 6.9}, {7, 7.1}}));
}

/// Sonar with one tube and one beam, for sums of echoes.
struct OneBeam {
  std::vector<std::uint32_t> of_tube{0};
  ReceiveBeams beams{1, of_tube, {}, {}};
  SampleFinder samples{RangeSamples{1, 0.5, 40}};
  EchoModel model;
  std::array<std::uint32_t, 1> tube{0};
};

TEST(TargetEcho, IsTheClosedFormAndTheBoundsHoldIt) {
  OneBeam sonar;
  sonar.model.absorption_db_per_m = 0.3;
  BeamPatterns patterns;
  Directivity line;
  line.kind = Directivity::Kind::line;
  line.axis = {1, 0, 0};
  line.size = 5;
  Directivity wide;
  wide.kind = Directivity::Kind::gaussian;
  wide.axis = {0, 1, 0};
  wide.from_axis = true;
  wide.size = 1.2;
  patterns.transmit = {TransmitPattern(wide)};
  patterns.receive = {line};
  patterns.fan_of_tube = {0};
  patterns.beams_of_tube = {{0, 1}};
  sonar.model.patterns = &patterns;
  const glm::dvec3 d(0.5, 6.25, -2.75);
  const double sigma = cross_section_m2(-31), r = glm::length(d), beta = 0.3 * std::log(10) / 10;
  const double x = pi * 5 * 0.5 / r, sinc = std::sin(x) / x, angle = std::acos(6.25 / r);
  const double expected = sigma * std::pow(r, -4) * std::exp(-2 * beta * r) * sinc * sinc *
                          std::exp(-4 * std::log(2) * std::pow(angle / 1.2, 2));
  TargetEchoSum<double> sum(sonar.beams, sonar.samples, sonar.model);
  const auto leg = straight_leg<double>({d.x, d.y, d.z}, sonar.model);
  const auto bins = *bin_of_range(sonar.samples, at({0, 0, 0}), at(d), unit);
  sum.add(sigma, leg, leg, bins, sonar.tube, sonar.tube, true);
  EXPECT_NEAR(sum.sums()[bins.first], expected, 1e-12 * expected);
  TargetEchoSum<Interval> certified(sonar.beams, sonar.samples, sonar.model);
  const auto enclosed = straight_leg<Interval>({d.x, d.y, d.z}, sonar.model);
  certified.add(outwards(sigma, sigma, 8), enclosed, enclosed, bins, sonar.tube, sonar.tube, true);
  const CertifiedEcho echo = certified_echo_of(certified.sums(), 1);
  EXPECT_NEAR(echo.echo.energy[bins.first], expected, echo.bound[bins.first]);
  EXPECT_LT(echo.bound[bins.first], 1e-11 * expected);
  EXPECT_GT(echo.bound[bins.first], 0);
}

TEST(TargetEcho, ReturnsOnlyThroughTubesOfItsFan) {
  const std::vector<std::uint32_t> beams{0, 1, 2}, fans{0, 0, 1};
  const ReceiveBeams three{3, beams, fans, fans};
  const SampleFinder samples(RangeSamples{1, 10, 1});
  const EchoModel model{};
  TargetEchoSum<double> sum(three, samples, model);
  const auto leg = straight_leg<double>({0, 2, 0}, model);
  const std::array<std::uint32_t, 1> out{0};
  const std::array<std::uint32_t, 3> back{0, 1, 2};
  sum.add(16, leg, leg, {0, 1, true}, out, back, false);
  EXPECT_EQ(sum.sums(), (std::vector<double>{1, 1, 0}));
}

// The receivers lie a quarter of a metre from the middle. Path differences are computed without the formula
// of the program.
TEST(TargetPair, HasEnergiesAndPhaseOfBothReceivers) {
  ReceiverBaseline pair;
  pair.axis = glm::normalize(glm::dvec3(0.1, -0.2, 1));
  pair.baseline_m = 0.5;
  pair.wavenumber_rad_m = 400;
  BeamPatterns patterns;
  patterns.transmit = {TransmitPattern()};
  patterns.receive = {Directivity()};
  patterns.baselines = {pair};
  EchoModel model{};
  model.patterns = &patterns;
  const SampleFinder samples(RangeSamples{5, 3, 4});
  const glm::dvec3 there(3, 6, -2), back(2.5, 6.5, -2.25);
  const glm::dvec3 half = 0.25 * pair.axis;
  const double sigma = 0.02, tx = glm::length(there), up = glm::length(back - half),
               down = glm::length(back + half);
  TargetPairSum<double> sum(pair, 0, samples, model);
  sum.add(sigma, there, back, true, true);
  const auto row = [&](const auto& sums, std::size_t k) { return sums[4 * k + 0]; };
  EXPECT_NEAR(row(sum.sums(), 0), sigma / std::pow(tx * up, 2), 1e-15);
  EXPECT_NEAR(row(sum.sums(), 1), sigma / std::pow(tx * down, 2), 1e-15);
  const auto product = sigma / (tx * tx * up * down) * std::polar(1.0, 400 * (up - down));
  EXPECT_NEAR(row(sum.sums(), 2), product.real(), 1e-12 * std::abs(product));
  EXPECT_NEAR(row(sum.sums(), 3), product.imag(), 1e-12 * std::abs(product));
  TargetPairSum<Interval> certified(pair, 0, samples, model);
  certified.add(sigma, there, back, true, true);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_LE(row(certified.sums(), k).lo, row(sum.sums(), k));
    EXPECT_GE(row(certified.sums(), k).hi, row(sum.sums(), k));
    EXPECT_LT(row(certified.sums(), k).width(), 1e-9 * std::abs(product));
  }
  // A receiver that does not see the target has neither its energy nor the product.
  TargetPairSum<double> one(pair, 0, samples, model);
  one.add(sigma, there, back, true, false);
  EXPECT_GT(row(one.sums(), 0), 0);
  for (std::size_t k = 1; k < 4; ++k) EXPECT_EQ(row(one.sums(), k), 0);
}

TEST(StrengthOverDirection, IsLinearBetweenItsAnglesAndPeriodic) {
  const std::vector<double> elevations{-10, 30}, azimuths{0, 90, 180, 270}, frequencies{1e5, 3e5};
  std::vector<double> values;
  for (const double e : elevations)
    for (const double a : azimuths)
      for (const double f : frequencies) values.push_back(100 + e + a + f / 1e5);
  const StrengthOverDirection table(elevations, azimuths, frequencies, values);
  const auto towards_of = [](double azimuth_deg, double elevation_deg) {
    const double a = azimuth_deg * pi / 180, e = elevation_deg * pi / 180;
    return glm::dvec3(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e));
  };
  EXPECT_NEAR(table.at(towards_of(45, 5), 2e5), 100 + 5 + 45 + 2, 1e-9);
  EXPECT_NEAR(table.at(towards_of(-90, 20), 1e5), 100 + 20 + 270 + 1, 1e-9);
  EXPECT_NEAR(table.at(towards_of(315, 30), 3e5), 100 + 30 + 135 + 3, 1e-9) << "between 270 and 360 degrees";
  EXPECT_NEAR(table.at(towards_of(90, 80), 9e5), 100 + 30 + 90 + 3, 1e-9) << "beyond the table";
  EXPECT_TRUE(table.covers(1e5) && table.covers(3.01e5) && !table.covers(4e5));
  EXPECT_THROW(StrengthOverDirection({0}, {0, 10, 20}, {1}, {1, 1, 1}), std::invalid_argument);
  EXPECT_THROW(StrengthOverDirection({0, 0}, {0}, {1}, {1, 1}), std::invalid_argument);
  EXPECT_THROW(StrengthOverDirection({0}, {0}, {1}, {-1}), std::invalid_argument);
}

TargetPopulation school(double density, double spread_db = 0) {
  TargetPopulation population;
  population.lo_m = {-6.3, 2.1, -5.7};
  population.hi_m = {5.2, 14.9, 4.4};
  population.density_per_m3 = density;
  population.target_strength_db = -40;
  population.spread_db = spread_db;
  population.seed = 77;
  return population;
}

std::map<GridPoint, double> all_of(const TargetPopulation& population, GridPoint apex = {0, 0, 0}) {
  std::map<GridPoint, double> drawn;
  draw_targets(population, apex, nullptr, target_grid, {0, 1e3},
               [&](const WaterTarget& target, std::span<const std::uint32_t>) {
                 drawn[target.at] += target.cross_section_m2;
               });
  return drawn;
}

TEST(PoissonQuantile, InvertsTheDistribution) {
  for (const double mean : {0.3, 1.0, 4.4, 8.0, 16.0})
    for (const double p : {1e-9, 0.01, 0.3, 0.5, 0.9, 0.999, 1 - 1e-12}) {
      const std::uint32_t count = poisson_quantile(p, mean);
      const boost::math::poisson law(mean);
      EXPECT_GE(cdf(law, count) * (1 + 1e-12), p);
      if (count > 0) {
        EXPECT_LT(cdf(law, count - 1), p * (1 + 1e-12));
      }
    }
}

// The counts in disjoint boxes are independent Poisson variates of the mean density times volume.
TEST(TargetPopulation, HasPoissonCountsAndUniformPlaces) {
  for (const double density : {0.07, 3.0}) {
    TargetPopulation population = school(density);
    std::vector<double> counts;
    std::array<std::size_t, 2> halves{};
    for (std::uint64_t seed = 0; seed < 400; ++seed) {
      population.seed = seed;
      double inside = 0;
      for (const auto& [point, sigma] : all_of(population)) {
        const glm::dvec3 p = metres(point);
        inside += p.x > -1 && p.x < 2.5 && p.y > 3 && p.y < 8 && p.z > -2 && p.z < 2;
        ++halves[p.x < (population.lo_m.x + population.hi_m.x) / 2 ? 0 : 1];
      }
      counts.push_back(inside);
    }
    const double expected = density * 3.5 * 5 * 4, n = double(counts.size());
    double mean = 0, variance = 0;
    for (const double count : counts) mean += count / n;
    for (const double count : counts) variance += (count - mean) * (count - mean) / (n - 1);
    EXPECT_NEAR(mean, expected, 4 * std::sqrt(expected / n));
    // The variance of the sample variance of a Poisson variate is (mu + 2 mu^2) / n.
    EXPECT_NEAR(variance, expected, 4 * std::sqrt((expected + 2 * expected * expected) / n));
    const double all = double(halves[0] + halves[1]);
    EXPECT_NEAR(double(halves[0]) / all, 0.5, 4 * 0.5 / std::sqrt(all));
    EXPECT_NEAR(all / n, population.expected(), 4 * std::sqrt(population.expected() / n));
  }
}

TEST(TargetPopulation, IsTheSameForAllApexesAndTubes) {
  const TargetPopulation population = school(2.5, 3);
  const std::map<GridPoint, double> all = all_of(population);
  ASSERT_GT(all.size(), 1000u);
  EXPECT_EQ(all, all_of(population, at({3, -2, 1})));
  for (const glm::dvec3 apex_m : {glm::dvec3(0, 0, 0), glm::dvec3(2, -3, 1), glm::dvec3(-1, 8, 0)}) {
    const TubeSet set = around(apex_m, -35, 20, 5, 12, 9);
    const TubeWalls walls(set);
    std::map<GridPoint, double> in_tubes, expected;
    WaterTargets targets;
    targets.populations = {population};
    const TargetReach reach{1.5, 7};
    each_target_in(targets, walls, target_grid, reach,
                   [&](const WaterTarget& target, std::span<const std::uint32_t> tubes) {
                     EXPECT_EQ(tubes.size(), 1u);
                     in_tubes[target.at] = target.cross_section_m2;
                   });
    std::vector<std::uint32_t> found;
    for (const auto& [point, sigma] : all) {
      const double range_m = glm::length(metres(point) - apex_m);
      walls.find(point, found);
      if (!found.empty() && range_m >= reach.nearest_m && range_m <= reach.farthest_m)
        expected[point] = sigma;
    }
    EXPECT_GT(expected.size(), 50u);
    EXPECT_EQ(in_tubes, expected);
  }
  // A smaller box has the same targets within it.
  TargetPopulation part = population;
  part.hi_m = {1, 9, 0.5};
  for (const auto& [point, sigma] : all_of(part)) EXPECT_EQ(all.at(point), sigma);
  TargetPopulation other = population;
  other.seed = 78;
  EXPECT_NE(all, all_of(other));
}

// The mean echo of a population is the volume-scattering integral s_v Omega integral r^-2 e^(-2 beta r) dr.
// Here s_v is the density times the mean cross-section. Without absorption, the integral is 1/r0 - 1/r1.
TEST(TargetPopulation, ReturnsInTheMeanWhatScatteringWaterReturns) {
  TargetPopulation population = school(4, 4);
  population.lo_m = {-9, -9, -9};
  population.hi_m = {9, 9, 9};
  const TubeSet set = around({0.3, -0.2, 0.1}, -20, 25, 1, 12, 8);
  const TubeWalls walls(set);
  const SampleFinder samples(RangeSamples{3, 1, 4});
  const EchoModel model{};
  const std::vector<std::uint32_t> one_beam(set.tubes.size(), 0);
  const ReceiveBeams beams{1, one_beam, {}, {}};
  constexpr int draws = 150;
  std::vector<double> mean(4), square(4);
  for (int draw = 0; draw < draws; ++draw) {
    population.seed = std::uint64_t(1000 + draw);
    WaterTargets targets;
    targets.populations = {population};
    TargetEchoSum<double> sum(beams, samples, model);
    each_target_in(targets, walls, target_grid, {3, 7},
                   [&](const WaterTarget& target, std::span<const std::uint32_t> tubes) {
                     const glm::dvec3 d = metres(target.at) - metres(set.apex);
                     const auto leg = straight_leg<double>({d.x, d.y, d.z}, model);
                     if (const auto bins = bin_of_range(samples, set.apex, target.at, unit))
                       sum.add(target.cross_section_m2, leg, leg, *bins, tubes, tubes, true);
                   });
    for (std::size_t k = 0; k < 4; ++k) {
      mean[k] += sum.sums()[k] / draws;
      square[k] += sum.sums()[k] * sum.sums()[k] / draws;
    }
  }
  // Walls of constant elevation are planes through neighbouring corner rays, so the solid angle is that of
  // the pyramids.
  double solid_angle = 0;
  for (const Tube& tube : set.tubes) {
    std::array<glm::dvec3, 4> ray;
    for (std::size_t k = 0; k < 4; ++k)
      ray[k] = glm::normalize(glm::dvec3(set.rays[tube[k]].x, set.rays[tube[k]].y, set.rays[tube[k]].z));
    for (const std::size_t k : {1, 2})
      solid_angle += 2 * std::atan2(std::abs(glm::dot(ray[0], glm::cross(ray[k], ray[k + 1]))),
                                    1 + glm::dot(ray[0], ray[k]) + glm::dot(ray[k], ray[k + 1]) +
                                        glm::dot(ray[k + 1], ray[0]));
  }
  const double s_v = population.density_per_m3 * population.mean_cross_section_m2();
  for (std::size_t k = 0; k < 4; ++k) {
    const double expected = s_v * solid_angle * (1 / (3.0 + double(k)) - 1 / (4.0 + double(k)));
    const double error = std::sqrt((square[k] - mean[k] * mean[k]) / draws);
    EXPECT_NEAR(mean[k], expected, 4 * error) << "bin " << k;
    EXPECT_LT(error, 0.03 * expected);
  }
}

// A straight track at constant speed: the delay has a closed form.
TEST(TargetSignals, HaveDelayPhaseAndDopplerOfTheirPath) {
  CoherentReceiver receiver;
  receiver.pulse = {[](double t) { return std::polar(1.0, 300 * t); }, 0, 2e-3, 1e4};
  receiver.times = {0.008, 20e3, 200};
  receiver.carrier_hz = 40e3;
  receiver.sound_speed_m_s = 1500;
  const glm::dvec3 place(2, 9, -3), transmit(0.1, 0, 0), receive(-0.2, 0.3, 0.1), speed(1.5, 2, 0);
  WaterTarget target;
  target.cross_section_m2 = 0.01;
  const double absorption = 0.2, beta = absorption * std::log(10) / 10;
  SignalChannel still{transmit, receive};
  std::vector<std::complex<double>> received(200), moved(200);
  const ReachedSamples reached = add_target_signal(target, place, still, receiver, absorption, received);
  const double tx = glm::distance(place, transmit), rx = glm::distance(place, receive), path = tx + rx;
  std::size_t sounding = 0;
  for (std::size_t k = 0; k < 200; ++k) {
    const double t = receiver.times.time_s(k) - path / 1500;
    const std::complex<double> expected = t >= 0 && t <= 2e-3
                                              ? 0.1 * std::exp(-beta * path / 2) / (tx * rx) *
                                                    std::polar(1.0, 2 * pi * 40e3 * path / 1500 + 300 * t)
                                              : 0;
    EXPECT_NEAR(std::abs(received[k] - expected), 0, 1e-11) << k;
    sounding += expected != 0.0;
    if (expected != 0.0) {
      EXPECT_TRUE(k >= reached.first && k < reached.end);
    }
  }
  EXPECT_GE(sounding, 39u);
  SignalChannel moving = still;
  moving.transmit_motion = [&](double t) { return transmit + speed * t; };
  moving.receive_motion = [&](double t) { return receive + speed * t; };
  add_target_signal(target, place, moving, receiver, absorption, moved);
  for (std::size_t k = 0; k < 200; ++k) {
    const double t = receiver.times.time_s(k), back = glm::distance(place, receive + speed * t);
    // |place - transmit - speed t_e| = c (t_a - t_e) is quadratic in the time of emission.
    const double arrived = t - back / 1500;
    const glm::dvec3 d = place - transmit;
    const double a = 1500.0 * 1500 - glm::dot(speed, speed), b = glm::dot(d, speed) - 1500.0 * 1500 * arrived,
                 c = 1500.0 * 1500 * arrived * arrived - glm::dot(d, d);
    const double emitted = (-b - std::sqrt(b * b - a * c)) / a;
    const double there = glm::length(d - speed * emitted), length = there + back;
    const std::complex<double> expected =
        emitted >= 0 && emitted <= 2e-3 ? 0.1 * std::exp(-beta * length / 2) / (there * back) *
                                              std::polar(1.0, 2 * pi * 40e3 * length / 1500 + 300 * emitted)
                                        : 0;
    EXPECT_NEAR(std::abs(moved[k] - expected), 0, 1e-10) << k;
  }
  WaterTarget at_element = target;
  EXPECT_THROW(add_target_signal(at_element, transmit, still, receiver, 0, received), std::invalid_argument);
}

}  // namespace
}  // namespace tubefoot
