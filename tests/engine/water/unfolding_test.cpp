// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the unfolding of rays over horizontal mirrors in stratified water. The comparisons are arcs of
// circles (physics sheet, 2.1) and traced rays.

#include "engine/water/unfolding.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "engine/water/apparent_map.hpp"
#include "engine/water/ray_trace.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

/// A ray of one gradient over level mirrors, as arcs of circles (physics sheet, 2.1), in extended
/// precision.
struct Arcs {
  long double c0, g;
  struct Sum {
    long double x = 0, t = 0, s = 0, last_sine = 0;
  };
  Sum along(long double launch, long double from, const std::vector<double>& mirrors, long double to) const {
    const long double p = std::cos(launch) / (c0 + g * from);
    Sum sum;
    const auto sine = [&](long double depth) {
      return std::sqrt(1 - p * p * (c0 + g * depth) * (c0 + g * depth));
    };
    const auto add = [&](long double a, long double b) {
      sum.x += std::abs((sine(a) - sine(b)) / (p * g));
      sum.t += std::abs((std::atanh(sine(a)) - std::atanh(sine(b))) / g);
      sum.s += std::abs((std::asin(sine(a)) - std::asin(sine(b))) / (p * g));
      sum.last_sine = sine(b);
    };
    for (const double mirror : mirrors) {
      add(from, mirror);
      from = mirror;
    }
    add(from, to);
    return sum;
  }
};

// Surface and bottom of a channel with one gradient: times and angles of rays over up to five mirrors.
TEST(Unfolding, RaysOverAChannelsMirrorsAreArcsOfCircles) {
  const double surface = 3, bottom = -47;  // heights; depth 0 of the profile is at the surface
  for (const double g : {0.2, -0.35}) {
    const Arcs arcs{1490, g};
    // The profile has a point in the middle of the water, and one above the water.
    const WaterColumn water{SoundSpeedProfile({{-5, 1490 - 5 * g}, {21, 1490 + 21 * g}, {80, 1490 + 80 * g}}),
                            {0.001, 0.002, 0.003, 0.004}};
    EigenrayOptions options;
    options.deepest_turn_m = 50;
    for (const bool up_first : {true, false})
      for (std::size_t n = 0; n <= 5; ++n) {
        std::vector<double> mirrors, depths;
        for (std::size_t k = 0; k < n; ++k) {
          const bool at_surface = (k % 2 == 0) == up_first;
          mirrors.push_back(at_surface ? surface : bottom);
          depths.push_back(at_surface ? 0 : 50);
        }
        const UnfoldedWater unfolded = unfold(water, options, surface, mirrors, up_first);
        EXPECT_EQ(unfolded.unfolding.sign, n % 2 == 0 ? 1 : -1);
        const glm::dvec3 apex(0, 0, surface - 12);
        const ApparentMap apparent_map(unfolded.water, apex, surface, unfolded.rays, 1490,
                                       unfolded.unfolding);
        // No ray of this steepness turns.
        for (const double launch : {0.3, 0.7, 1.3}) {
          if (n == 0 && up_first) continue;
          const double to = 33;
          const Arcs::Sum expected = arcs.along(launch, 12, depths, to);
          const glm::dvec3 at(0.6 * double(expected.x), 0.8 * double(expected.x), surface - to);
          const auto seen = apparent_map.apparent(at);
          ASSERT_TRUE(seen) << n;
          const Eigenray& ray = seen->ray;
          EXPECT_EQ(ray.turns, 0);
          EXPECT_NEAR(ray.time_s, double(expected.t), 1e-12 * double(expected.t));
          EXPECT_NEAR(ray.length_m, double(expected.s), 1e-11 * double(expected.s));
          EXPECT_NEAR(ray.launch_sine, (up_first ? -1 : 1) * std::sin(launch), 1e-9);
          const glm::dvec3 arrives = apparent_map.arrival_direction(at, ray);
          const bool rises = (n % 2 == 0) == up_first;
          EXPECT_NEAR(arrives.z, (rises ? 1 : -1) * double(expected.last_sine), 1e-9);
          // Tube area: x sin(arrival) |dx/dlaunch| / cos(launch).
          const long double d = 1e-6L;
          const long double slope =
              (arcs.along(launch - d, 12, depths, to).x - arcs.along(launch + d, 12, depths, to).x) / (2 * d);
          const double area = double(expected.x * expected.last_sine * slope / std::cos((long double)launch));
          EXPECT_NEAR(ray.tube_area_m2_per_sr, area, 1e-9 * area);
          // The same ray, traced with its reflections.
          const auto nodes =
              trace_ray(water, 12, (up_first ? -1 : 1) * launch, {0, 50, double(expected.x), 10'000});
          EXPECT_NEAR(nodes.back().state.depth_m, to, 1e-8);
          EXPECT_NEAR(nodes.back().state.absorption_db, ray.absorption_db, 1e-9 * ray.absorption_db);
          // After an odd number of mirrors the image is upside down.
          EXPECT_NEAR((seen->at_m - apex).z,
                      (rises == up_first ? 1 : -1) * -1490 * ray.time_s * ray.launch_sine, 1e-9);
        }
      }
  }
}

// Physics sheet, 2.3: BELLHOP's "calibraygrad" starts at 6.5 degrees up. It reaches the surface if the
// water is cut off at the turning depth.
TEST(Unfolding, ARayThatTurnsAfterTheLastMirrorIsFound) {
  // Sound is faster below: rays from the surface turn, and return to the surface from below.
  const double g = 0.8;
  const WaterColumn water{SoundSpeedProfile({{0, 1480}, {200, 1480 + 200 * g}}), {}};
  EigenrayOptions options;
  options.deepest_turn_m = 150;
  const UnfoldedWater unfolded = unfold(water, options, 0, std::array{0.0}, true);
  const double launch = -12 * pi / 180;
  for (const double range : {300.0, 900.0}) {
    const auto nodes = trace_ray(water, 20, launch, {0, 1e9, range, 1000});
    const double depth = nodes.back().state.depth_m;
    std::size_t bounces = 0;
    for (const RayNode& node : nodes) bounces += node.event == RayEvent::surface;
    ASSERT_EQ(bounces, 1u);
    const ApparentMap apparent_map(unfolded.water, {0, 0, -20}, 0, unfolded.rays, 1480, unfolded.unfolding);
    const auto rays = apparent_map.finder().all(apparent_map.depth_m({range, 0, -depth}), range);
    const auto same = std::ranges::find_if(
        rays, [&](const Eigenray& ray) { return std::abs(ray.launch_sine - std::sin(launch)) < 1e-9; });
    ASSERT_NE(same, rays.end()) << range;
    EXPECT_NEAR(same->time_s, nodes.back().state.time_s, 1e-12);
    EXPECT_NEAR(same->tube_area_m2_per_sr, nodes.back().state.tube_area_m2_per_sr,
                1e-7 * same->tube_area_m2_per_sr);
    EXPECT_EQ(same->turns, range > 500 ? 1 : 0);
  }
}

TEST(Unfolding, MirrorsTakeTurns) {
  const WaterColumn water{SoundSpeedProfile({{0, 1480}, {20, 1490}}), {}};
  EXPECT_THROW(unfold(water, {}, 0, std::array{-5.0, -4.0}, true), std::invalid_argument);
  EXPECT_THROW(unfold(water, {}, 0, std::array{-5.0, -5.0}, false), std::invalid_argument);
  EXPECT_THROW(unfold(water, {}, 0, std::array{-5.0, -6.0}, false), std::invalid_argument);
  EXPECT_NO_THROW(unfold(water, {}, 0, std::array{-5.0, -6.0}, true));
}

}  // namespace
}  // namespace tubefoot
