// SPDX-License-Identifier: GPL-3.0-or-later
// Tests products of the signals of a receiver pair. The comparisons are true distances in space and closed
// forms of the phase and the coherence.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <random>

#include "engine/echo/echo.hpp"
#include "fixtures/geometry/plane_polygons.hpp"
#include "fixtures/world/histories.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

using test::on_plane;
using test::Polygon2;
using Complex = std::complex<double>;
using test::add_footprint;

constexpr double baseline_mu = 0.003;

Echo echo_of(const History& history, const RangeSamples& samples, const BeamPatterns& patterns,
             Binning binning = Binning::exact) {
  const std::vector<double> material_mu{baseline_mu};
  const std::vector<std::uint16_t> one_facet{0};
  const std::vector<std::uint32_t> beam_of_tube{0};
  return integrate_echo(history, {1, beam_of_tube}, samples,
                        EchoModel{material_mu, one_facet, 0, &patterns, 1e-11}, binning);
}

BeamPatterns patterns_of_one_beam(const ReceiverBaseline& baseline, const Directivity& transmit = {},
                                  const Directivity& receive = {}) {
  return {{transmit}, {receive}, {0}, {{0, 1}}, {baseline}};
}

Complex cross_of(const Echo& echo, int sample) {
  const auto k = std::size_t(sample), n = std::size_t(echo.samples);
  return {echo.energy.at(2 * n + k), echo.energy.at(3 * n + k)};
}

glm::dvec3 random_unit(std::mt19937_64& random) {
  std::normal_distribution<double> gauss;
  return glm::normalize(glm::dvec3(gauss(random), gauss(random), gauss(random)));
}

TEST(ReceiverBaseline, PathDifferenceIsThatOfTheTrueWays) {
  const unsigned seed = 8128;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> range(0.5, 200), share(0, 1);
  for (int i = 0; i < 1000; ++i) {
    ReceiverBaseline baseline{random_unit(random), 0, 1};
    const double r = range(random);
    baseline.baseline_m = r * std::pow(share(random), 4);
    const glm::dvec3 p = r * random_unit(random), upper = baseline.baseline_m / 2 * baseline.axis;
    const double expected = glm::distance(p, upper) - glm::distance(p, -upper);
    EXPECT_NEAR(baseline.path_difference(r, glm::dot(p, baseline.axis) / r), expected,
                4e-16 * r + 1e-13 * baseline.baseline_m);
  }
  // The lower receiver is nearer to points below.
  EXPECT_GT((ReceiverBaseline{{0, 0, 1}, 0.1, 1}.path_difference(10, -0.5)), 0);
}

/// A strip, 2 mm wide along the track, of a plane below the sonar that rises by `slope` to starboard (x).
struct Slope {
  double depth = 8, slope = 0.2;
  History history;

  Slope() {
    const FacetPlane plane{glm::normalize(glm::dvec3(-slope, 0, 1)), depth / std::hypot(1, slope)};
    const PlaneFrame frame(plane);
    const auto on = [&](double x, double y) { return frame.project({x, y, -depth + slope * x}); };
    Polygon2 strip{on(2, -0.001), on(2, 0.001), on(25, 0.001), on(25, -0.001)};
    double turn = 0;
    for (std::size_t i = 0; i < 4; ++i)
      turn += strip[i].x * strip[(i + 1) % 4].y - strip[i].y * strip[(i + 1) % 4].x;
    if (turn < 0) std::reverse(strip.begin(), strip.end());
    add_footprint(history, 0, 0, plane, {strip});
  }
};

ReceiverBaseline receiver_pair(double tilt_rad, double baseline_m, double wavelength_m) {
  return {{std::sin(tilt_rad), 0, std::cos(tilt_rad)}, baseline_m, 2 * pi / wavelength_m};
}

TEST(ReceiverBaseline, RaysAndCentroidsHaveThePhaseOfTheirPlace) {
  const ReceiverBaseline baseline = receiver_pair(0.3, 0.2, 0.01);
  const glm::dvec3 d = glm::normalize(glm::dvec3(2, 0.1, -1));
  History rays;
  rays.hits.push_back({0, 0, 7.25, 0.5, 1e-3, glm::vec3(d)});
  const double direct =
      2 * pi / 0.01 *
      (glm::distance(7.25 * d, 0.1 * baseline.axis) - glm::distance(7.25 * d, -0.1 * baseline.axis));
  const Echo echo = echo_of(rays, {7, 0.5, 1}, patterns_of_one_beam(baseline));
  EXPECT_GT(echo.at(0, 0), 0);
  // float direction
  EXPECT_LT(std::abs(cross_of(echo, 0) / echo.at(0, 0) - std::polar(1.0, direct)), 1e-4);

  Slope seabed;
  measure(seabed.history.footprints);
  const glm::dvec3 c = seabed.history.footprints.footprints[0].centroid_m;
  const double expected =
      2 * pi / 0.01 * (glm::distance(c, 0.1 * baseline.axis) - glm::distance(c, -0.1 * baseline.axis));
  const Echo binned = echo_of(seabed.history, {1, 30, 1}, patterns_of_one_beam(baseline), Binning::centroid);
  EXPECT_LT(std::abs(cross_of(binned, 0) / binned.at(0, 0) - std::polar(1.0, expected)), 1e-9);
}

// The ranges of the two receivers differ: a hit near a bin border falls into a different range bin for each
// receiver.
TEST(ReceiverBaseline, HitsAndCentroidsFallIntoEachReceiversOwnSample) {
  const ReceiverBaseline baseline = receiver_pair(0.3, 0.2, 0.01);
  const glm::dvec3 d = glm::normalize(glm::dvec3(2, 0.1, -1));
  const double range = 7.25, upper = (range + glm::distance(range * d, 0.1 * baseline.axis)) / 2,
               lower = (range + glm::distance(range * d, -0.1 * baseline.axis)) / 2;
  ASSERT_GT(upper - lower, 0.01);
  History rays;
  rays.hits.push_back({0, 0, range, 0.5, 1e-3, glm::vec3(d)});
  const double border = (upper + lower) / 2;
  const Echo apart =
      echo_of(rays, {border - 1, 1, 2}, patterns_of_one_beam(baseline));  // upper in 1, lower in 0
  const double all = echo_of(rays, {7, 0.5, 1}, patterns_of_one_beam(baseline)).energy[0];
  const std::vector<double> expected{0, all, all, 0, 0, 0, 0, 0};
  for (std::size_t k = 0; k < 8; ++k) EXPECT_DOUBLE_EQ(apart.energy.at(k), expected[k]) << k;

  Slope seabed;
  measure(seabed.history.footprints);
  const Echo whole = echo_of(seabed.history, {1, 30, 1}, patterns_of_one_beam(baseline), Binning::spread),
             cut = echo_of(seabed.history, {9, 0.01, 500}, patterns_of_one_beam(baseline), Binning::spread);
  const double per_sample = whole.energy[0] * 0.01 /
                            (seabed.history.footprints.footprints[0].slant_range_max_m -
                             seabed.history.footprints.footprints[0].slant_range_min_m);
  const glm::dvec3 c = seabed.history.footprints.footprints[0].centroid_m;
  const double shift =
      std::abs(glm::distance(c, 0.1 * baseline.axis) - glm::distance(c, -0.1 * baseline.axis)) / 2;
  for (int k = 100; k < 400; ++k) {
    EXPECT_NEAR(cut.energy.at(std::size_t(k)), per_sample, 1e-9 * per_sample);
    EXPECT_NEAR(cut.energy.at(500 + std::size_t(k)), per_sample, 1e-9 * per_sample);
    EXPECT_NEAR(std::abs(cross_of(cut, k)), std::max(1 - shift / 0.01, 0.0) * per_sample, 1e-9 * per_sample);
  }
}

TEST(ReceiverBaseline, FootprintsOfOneApexAreNotCutForTwoReceivers) {
  const Slope seabed;
  EXPECT_THROW(echo_of(seabed.history, {9, 0.5, 20}, patterns_of_one_beam(receiver_pair(0.4, 0.1, 0.006))),
               std::invalid_argument);
}

TEST(ReceiverBaseline, RefusesABaselineLongerThanTheNearestRange) {
  EXPECT_THROW(echo_of({}, {1, 1, 3}, patterns_of_one_beam(receiver_pair(0, 1.1, 0.01))),
               std::invalid_argument);
  BeamPatterns two = patterns_of_one_beam(receiver_pair(0, 0.1, 0.01));
  two.baselines.push_back(two.baselines[0]);
  EXPECT_THROW(echo_of({}, {1, 1, 3}, two), std::invalid_argument);
}

}  // namespace
}  // namespace tubefoot
