// SPDX-License-Identifier: GPL-3.0-or-later
// Tests a separate receiver with its own lever arm in whole runs (docs/environment.md). The comparisons are
// the monostatic run, closed forms of ellipses, and rays in one gradient.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "fixtures/scene_texts.hpp"
#include "fixtures/world/echoes.hpp"

namespace tubefoot {
namespace {

using testing::HasSubstr;

/// A sonar looks straight down from 5 m over a seabed. The sector is so wide that its sides lie outside of
/// the range gate.
std::string scene(const std::string& sensor_keys, const std::string& more = {}) {
  return still_water() + lambert_material("bed", -10) + flat_terrain(200, 200) + more + fixed_at(0, 0, 5) +
         R"(
[[sensors]]
name = "down"
kind = "didson"
beams = 3
horizontal_deg = 100
vertical_deg = 100
tilt_deg = 90
samples = 100
window_start_m = 4.5
window_length_m = 2
)" + sensor_keys +
         "\n";
}

double sum_of_sample(const Echoes& echoes, std::size_t sample) {
  double sum = 0;
  for (std::size_t beam = 0; beam < echoes.beams; ++beam) sum += echoes.at(0, beam, sample);
  return sum;
}

TEST(BistaticRun, AReceiverAtTheTransmitterReceivesTheSame) {
  const Echoes alone = echoes_of(scene(""));
  const Echoes same = echoes_of(scene("receiver_arm_m = [0, 0, 0]"));
  EXPECT_EQ(alone.energy, same.energy);
  // A tiny lever arm selects the bistatic kernel and integral, and gives almost the same echo.
  const Echoes near = echoes_of(scene("receiver_arm_m = [0, 0, 1e-6]"));
  for (std::size_t k = 0; k < alone.samples; ++k)
    EXPECT_NEAR(sum_of_sample(near, k), sum_of_sample(alone, k), 1e-4 * sum_of_sample(alone, k) + 1e-12) << k;
}

// Transmitter and receiver are at the same height h, with baseline b. Half of the shortest path is sqrt(h^2
// + (b/2)^2), and no nearer sound returns. The ring of the seabed between half paths l and l + dl returns
// mu h^2 / (r_T^3 r_R^3) per area. The test integrates this on a fine grid in elliptic coordinates.
TEST(BistaticRun, RangesAreHalfPathsAlongEllipses) {
  const double h = 5, b = 3, mu = 0.1;
  const Echoes echoes = echoes_of(scene("receiver_arm_m = [3, 0, 0]"));
  const double shortest = std::hypot(h, b / 2);
  for (std::size_t k = 0; k < echoes.samples; ++k) {
    const double from = std::max(echoes.first_m(k), shortest), to = echoes.last_m(k);
    if (to <= shortest) {
      EXPECT_EQ(sum_of_sample(echoes, k), 0) << k;
      continue;
    }
    // An ellipsoid of half path l meets the seabed in an ellipse:
    //   x = l s cos(t), y = B s sin(t), B = sqrt(l^2 - (b/2)^2), s = sqrt(1 - h^2 / B^2).
    const auto point = [&](double l, double t) {
      const double minor = std::sqrt(l * l - b * b / 4),
                   s = std::sqrt(std::max(0.0, 1 - h * h / (minor * minor)));
      return std::pair(l * s * std::cos(t), minor * s * std::sin(t));
    };
    constexpr int steps = 200, turns = 400;
    double expected = 0;
    for (int i = 0; i < steps; ++i)
      for (int j = 0; j < turns; ++j) {
        // s grows like a square root at the shortest path, so that the steps are uniform in its square.
        const auto at = [&](double u) { return from + (to - from) * u * u; };
        const double l0 = at(double(i) / steps), l1 = at((i + 1.0) / steps), l = at((i + 0.5) / steps);
        const double t0 = 2 * std::numbers::pi * j / turns, t1 = 2 * std::numbers::pi * (j + 1) / turns;
        const auto [ax, ay] = point(l0, t0);
        const auto [bx, by] = point(l1, t0);
        const auto [cx, cy] = point(l1, t1);
        const auto [dx, dy] = point(l0, t1);
        const double area = ((cx - ax) * (dy - by) - (dx - bx) * (cy - ay)) / 2;
        const auto [x, y] = point(l, (t0 + t1) / 2);
        const double rt = std::hypot(x + b / 2, y, h), rr = std::hypot(x - b / 2, y, h);
        expected += mu * h * h * area / std::pow(rt * rr, 3);
      }
    EXPECT_NEAR(sum_of_sample(echoes, k), expected, 2e-3 * expected) << k;
  }
}

// A wall between the two hides from each the side of the other.
TEST(BistaticRun, WhatOneOfTheTwoCannotSeeIsSilent) {
  const std::string wall = R"([[objects]]
name = "wall"
shape = "box"
size_m = [0.1, 150, 4.9]
position_m = [0, 0, 2.4]
)";
  const Echoes open = echoes_of(scene("lever_arm_m = [-1, 0, -1.5]\nreceiver_arm_m = [1, 0, -1.5]"));
  const Echoes shut = echoes_of(scene("lever_arm_m = [-1, 0, -1.5]\nreceiver_arm_m = [1, 0, -1.5]", wall));
  EXPECT_GT(open.total(), 0);
  EXPECT_EQ(shut.total(), 0);
}

// In water of one gradient the rays to a point of the seabed have closed forms (physics sheet 2.2). The
// test sums points of a fine grid, each in the range bin of its travel times.
TEST(BistaticRun, RefractingWaterBendsBothWays) {
  const double h = 5, b = 3, mu = 0.1, g = -10, cs = 1500, cr = cs + g * h;
  const std::string even = scene("receiver_arm_m = [3, 0, 0]");
  const auto at = even.find("sound_speed_m_s = 1500");
  ASSERT_NE(at, std::string::npos);
  std::string layered = even;
  layered.replace(at, 22,
                  "surface_height_m = 10\nprofile = \"gradient\"\nsound_speed_m_s = 1550\n"
                  "gradient_per_s = -10\nprofile_bottom_m = 12");
  const Echoes straight = echoes_of(even), refracted = echoes_of(layered);
  std::vector<double> expected(refracted.samples);
  const double cell = 0.005, step = refracted.last_m(0) - refracted.first_m(0);
  struct Arc {
    double time_s, sine, tube_m2;
  };
  const auto way = [&](double x, double y) {
    const double along = std::hypot(x, y), chord = std::hypot(along, h);
    const double time = std::acosh(1 + g * g * chord * chord / (2 * cs * cr)) / -g;
    return Arc{time, std::sin(std::asin(h / chord) - std::atan(g * along / (cs + cr))),
               std::pow(cr * std::sinh(g * time) / g, 2)};
  };
  for (double x = -6 + cell / 2; x < 6; x += cell)
    for (double y = cell / 2; y < 5; y += cell) {  // and the other half
      const Arc tx = way(x - b / 2, y), rx = way(x + b / 2, y);
      const double sample = (cs * (tx.time_s + rx.time_s) / 2 - refracted.first_m(0)) / step;
      if (sample >= double(expected.size())) continue;
      expected[std::size_t(sample)] +=
          2 * mu * tx.sine * rx.sine * cell * cell * cr * cr / (tx.tube_m2 * rx.tube_m2 * cs * cs);
    }
  double difference = 0, all = 0, far_m = std::hypot(h, b / 2) * 1.08;
  for (std::size_t k = 0; k < expected.size(); ++k) {
    if (refracted.first_m(k) < far_m || refracted.last_m(k) > 6.4) continue;
    EXPECT_NEAR(sum_of_sample(refracted, k) / expected[k], 1, 0.03) << k;
    difference += std::abs(sum_of_sample(straight, k) / expected[k] - 1);
    all += sum_of_sample(refracted, k) / expected[k] - 1;
  }
  EXPECT_LT(std::abs(all) / 40, 0.005);  // the cells of the grid are not biased to a side
  EXPECT_GT(difference / 40, 0.03);
}

// Compares rays, fast binning and plain doubles, in isovelocity and in stratified water.
TEST(BistaticRun, TheCheaperSettingsHearTheSame) {
  std::string layered = scene("receiver_arm_m = [3, 0, 0]");
  layered.replace(layered.find("sound_speed_m_s = 1500"), 22,
                  "surface_height_m = 10\nprofile = \"gradient\"\nsound_speed_m_s = 1550\n"
                  "gradient_per_s = -10\nprofile_bottom_m = 12");
  for (const std::string& text : {scene("receiver_arm_m = [3, 0, 0]"), layered}) {
    const Echoes exact = echoes_of(text), rays = echoes_of(text, {"--engine", "ray", "--rays", "400000"}),
                 doubles = echoes_of(text, {"--arithmetic", "double"});
    double by_rays = 0, lit = 0;
    for (std::size_t k = 0; k < exact.samples; ++k) {
      const double sum = sum_of_sample(exact, k);
      by_rays += std::abs(sum_of_sample(rays, k) - sum);
      lit += sum;
      EXPECT_NEAR(sum_of_sample(doubles, k), sum, 1e-11 * exact.total()) << k;
    }
    EXPECT_GT(by_rays, 0);
    EXPECT_LT(by_rays, 0.02 * lit);
    for (const char* binning : {"spread", "centroid"}) {
      const Echoes fast = echoes_of(text, {"--binning", binning});
      EXPECT_NE(fast.energy, exact.energy);
      EXPECT_GT(fast.total(), 0.3 * exact.total()) << binning;  // for footprints as large as the range gate
      EXPECT_LT(fast.total(), 3 * exact.total()) << binning;
    }
  }
}

TEST(BistaticRun, ReferencesHoldTheOrdinaryEnergies) {
  const std::string apart = scene("receiver_arm_m = [3, 0, 0]");
  const Echoes ordinary = echoes_of(apart),
               reference = echoes_of(apart, {"--reference", "--tolerance", "1e-6"});
  ASSERT_EQ(reference.energy_bound.size(), ordinary.energy.size());
  double most = 0;
  for (const double energy : ordinary.energy) most = std::max(most, energy);
  for (std::size_t k = 0; k < ordinary.energy.size(); ++k) {
    EXPECT_LE(std::abs(reference.energy[k] - ordinary.energy[k]),
              reference.energy_bound[k] + 1e-9 * ordinary.energy[k] + 1e-15 * most)
        << k;
    EXPECT_LE(reference.energy_bound[k], 1e-6 * std::max(reference.energy[k], 1e-6 * most)) << k;
  }
}

}  // namespace
}  // namespace tubefoot
