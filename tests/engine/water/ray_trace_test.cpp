// SPDX-License-Identifier: GPL-3.0-or-later
// Tests ray traces through layered water with reflections: calibration cases, vertices and skips in closed
// form, images of a channel, and published short-range tables.

#include "engine/water/ray_trace.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/water/ray_arc.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

double degrees(const RayState& s) { return std::atan2(s.sine, s.cosine) / degree; }

WaterColumn gradient(double c0, double g, double bottom_m) {
  return {SoundSpeedProfile({{0, c0}, {bottom_m, c0 + g * bottom_m}}), {}};
}

TEST(RayTrace, CalibrationCaseOfOneGradientBetweenSurfaceAndBottom) {
  const WaterColumn water{SoundSpeedProfile({{0, 1500}, {100, 1480}}), {}};
  const struct {
    double launch, depth, angle, time, length;
    int bottoms;
  } rows[] = {{-6.5, 20.2144, -4.01625, 6.7269872, 10043.8575, 4},
              {-5.969388, 9.7280, -0.55002, 6.7273574, 10039.0656, 4},
              {-0.132653, 58.6605, -2.76613, 6.7424193, 10023.0689, 6},
              {0.132653, 57.0739, -2.50054, 6.7424683, 10023.1054, 6},
              {3.051020, 95.0458, 7.00069, 6.7393046, 10027.8407, 5},
              {5.969388, 56.3072, -6.41660, 6.7338548, 10043.9061, 5},
              {6.5, 94.0357, 8.99609, 6.7291556, 10045.4722, 4}};
  for (const auto& row : rows) {
    const auto nodes = trace_ray(water, 50, row.launch * degree,
                                 {.surface_m = 0, .bottom_m = 100, .longest_range_m = 10000});
    const RayState& end = nodes.back().state;
    EXPECT_EQ(nodes.back().event, RayEvent::end);
    EXPECT_NEAR(end.range_m, 10000, 1e-9);
    EXPECT_NEAR(end.depth_m, row.depth, 6e-5) << row.launch;
    EXPECT_NEAR(degrees(end), row.angle, 6e-6) << row.launch;
    EXPECT_NEAR(end.time_s, row.time, 6e-8) << row.launch;
    EXPECT_NEAR(end.length_m, row.length, 6e-5) << row.launch;
    EXPECT_EQ(std::count_if(nodes.begin(), nodes.end(),
                            [](const RayNode& n) { return n.event == RayEvent::bottom; }),
              row.bottoms);
  }
}

TEST(RayTrace, VertexAndSkipInOneGradient) {
  const WaterColumn water = gradient(1500, 0.016, 5000);
  const auto nodes = trace_ray(water, 1000, 5 * degree, {.longest_range_m = 20000});
  ASSERT_GE(nodes.size(), 2u);
  ASSERT_TRUE(nodes[1].turned_at_m);
  EXPECT_NEAR(*nodes[1].turned_at_m, 1361.929607, 6e-7);
  EXPECT_NEAR(nodes[1].state.range_m, 16579.101738, 6e-7);
  EXPECT_NEAR(nodes[1].state.range_m / 2, 8289.550869, 6e-7);
  EXPECT_NEAR(nodes[1].state.time_s, 10.922179, 6e-7);
  EXPECT_NEAR(nodes[1].state.time_s / 2, 5.461089748, 6e-10);
  EXPECT_NEAR(nodes[1].state.length_m, 16600.163296, 6e-7);
  EXPECT_NEAR(degrees(nodes[1].state), -5, 1e-12);
}

TEST(RayTrace, EndBetweenVertexAndSkipStatesTheDepthOfTheVertex) {
  const auto nodes = trace_ray(gradient(1500, 0.016, 5000), 1000, 5 * degree, {.longest_range_m = 10000});
  ASSERT_EQ(nodes.size(), 2u);
  ASSERT_TRUE(nodes.back().turned_at_m);
  EXPECT_NEAR(*nodes.back().turned_at_m, 1361.929607, 6e-7);
}

TEST(RayTrace, TubeAreaIsTheDerivativeOfRangeBeforeAndAfterATurningPoint) {
  const WaterColumn channel{SoundSpeedProfile({{0, 1510}, {50, 1500}, {100, 1510}}), {}};
  const auto nodes_at = [&](double launch) {
    return trace_ray(channel, 40, launch, {.longest_range_m = 1e4});
  };
  const double launch = 4 * degree, step = 1e-5;
  const auto nodes = nodes_at(launch), less = nodes_at(launch - step), more = nodes_at(launch + step);
  ASSERT_GE(nodes.size(), 6u);
  EXPECT_TRUE(nodes[2].turned_at_m && nodes[4].turned_at_m);
  for (std::size_t k = 1; k < 6; ++k) {
    const RayState& state = nodes[k].state;
    ASSERT_EQ(less[k].state.depth_m, state.depth_m);
    ASSERT_EQ(more[k].state.depth_m, state.depth_m);
    const double range_per_rad = (more[k].state.range_m - less[k].state.range_m) / (2 * step);
    const double area = state.range_m * std::abs(range_per_rad * state.sine) / std::cos(launch);
    EXPECT_NEAR(state.tube_area_m2_per_sr / area, 1, 1e-5) << "node " << k;
  }
}

TEST(RayTrace, SkipsOfALinearSquareOfIndex) {
  const auto speed = [](double z) { return n2_linear_sound_speed_m_s(z, 1550, 1.2); };
  const WaterColumn water{SoundSpeedProfile(sample_profile(speed, 0, 1200, 0.5)), {}};
  const struct {
    double launch, skip;
  } rows[] = {{20, 2115.842549}, {30, 2850.666954}, {44, 3289.661472}, {46, 3289.661472}, {50, 3241.658854}};
  for (const auto& row : rows) {
    const auto nodes = trace_ray(water, 1000, -row.launch * degree, {.longest_range_m = 5000});
    const auto back = std::find_if(nodes.begin() + 1, nodes.end(),
                                   [](const RayNode& n) { return n.state.depth_m == 1000; });
    ASSERT_NE(back, nodes.end());
    EXPECT_NEAR(back->state.range_m / row.skip, 1, 1e-5) << row.launch;
    EXPECT_NEAR(degrees(back->state), row.launch, 1e-9);
  }
}

TEST(RayTrace, CyclesOfTheDeepSoundChannel) {
  const auto speed = [](double z) { return munk_sound_speed_m_s(z); };
  const struct {
    double launch, range, period, upper, lower, by_bellhop;
  } rows[] = {{14, 64958.6003, 43.127930, 10.9345, 4730.3828, 64961.28},
              {5, 50185.5200, 33.452879, 679.2188, 2207.5399, 50185.59}};
  for (const double step : {10., 1.}) {
    const WaterColumn water{SoundSpeedProfile(sample_profile(speed, 0, 5000, step)), {}};
    for (const auto& row : rows) {
      for (const double sign : {-1., 1.}) {
        const auto nodes =
            trace_ray(water, 1000, sign * row.launch * degree, {.surface_m = 0, .longest_range_m = 70000});
        const auto cycle = std::find_if(nodes.begin() + 1, nodes.end(), [&](const RayNode& n) {
          return n.state.depth_m == 1000 && n.state.sine * sign > 0;
        });
        ASSERT_NE(cycle, nodes.end());
        const double relative = step == 10 ? 3e-4 : 3e-6;
        EXPECT_NEAR(cycle->state.range_m / row.range, 1, relative);
        EXPECT_NEAR(cycle->state.time_s / row.period, 1, relative);
        if (step == 10) {
          EXPECT_NEAR(cycle->state.range_m, row.by_bellhop, 0.006);
        }
        double upper = 1e9, lower = 0;
        for (auto n = nodes.begin(); n != cycle; ++n) {
          if (!n->turned_at_m) continue;
          upper = std::min(upper, *n->turned_at_m);
          lower = std::max(lower, *n->turned_at_m);
        }
        EXPECT_NEAR(upper, row.upper, step == 10 ? 0.2 : 2e-3);
        EXPECT_NEAR(lower, row.lower, step == 10 ? 0.2 : 2e-3);
      }
    }
  }
}

TEST(RayTrace, ImagesOfAnEvenChannel) {
  const WaterColumn water{SoundSpeedProfile(1539), {}};
  // Transmitter at 5 m, receiver 100 m away at 10 m, 20 m of water; the images lie at -10 and at 30 m.
  const struct {
    double image, time;
    RayEvent by;
  } rows[] = {{10, 0.0650, RayEvent::end}, {-10, 0.0657, RayEvent::surface}, {30, 0.0670, RayEvent::bottom}};
  for (const auto& row : rows) {
    const auto nodes = trace_ray(water, 5, std::atan2(row.image - 5, 100),
                                 {.surface_m = 0, .bottom_m = 20, .longest_range_m = 100});
    EXPECT_EQ(nodes[1].event, row.by);
    EXPECT_NEAR(nodes.back().state.depth_m, 10, 1e-12);
    EXPECT_NEAR(nodes.back().state.time_s, row.time, 6e-5);
    const double path = std::hypot(100, row.image - 5);
    EXPECT_NEAR(nodes.back().state.time_s, path / 1539, 1e-15);
    EXPECT_NEAR(nodes.back().state.tube_area_m2_per_sr, path * path, 1e-9 * path * path);
  }
}

TEST(RayTrace, AbsorptionFollowsThePathLayerByLayer) {
  WaterColumn water{SoundSpeedProfile({{0, 1500}, {10, 1500}, {20, 1500}}), {1, 2, 3, 4}};
  const auto nodes = trace_ray(water, 5, 45 * degree, {.longest_range_m = 25});
  EXPECT_NEAR(nodes.back().state.absorption_db, std::sqrt(2) * (5 * 2 + 10 * 3 + 10 * 4), 1e-12);
}

TEST(RayTrace, HorizontalRays) {
  const auto end = [](const WaterColumn& water, double depth_m) {
    return trace_ray(water, depth_m, 0, {.longest_range_m = 100}).back().state;
  };
  EXPECT_EQ(end(WaterColumn{SoundSpeedProfile(1500), {}}, 7).depth_m, 7);
  EXPECT_NEAR(end(WaterColumn{SoundSpeedProfile(1500), {}}, 7).tube_area_m2_per_sr, 1e4, 1e-8);
  // On the axis of a channel the ray stays at its depth.
  const WaterColumn channel{SoundSpeedProfile({{0, 1510}, {50, 1500}, {100, 1510}}), {}};
  EXPECT_EQ(end(channel, 50).depth_m, 50);
  EXPECT_NEAR(end(channel, 50).time_s, 100 / 1500., 1e-15);
  // Elsewhere the ray bends to the slower side, on an arc of radius c / g.
  const double radius = 1505 / 0.2, sag = radius - std::sqrt(radius * radius - 1e4);
  EXPECT_NEAR(end(channel, 25).depth_m, 25 + sag, 1e-9);
  EXPECT_NEAR(end(channel, 75).depth_m, 75 - sag, 1e-9);
  const double y = 0.2 * std::hypot(100, sag) / 2 / std::sqrt(1505 * (1505 - 0.2 * sag));
  EXPECT_NEAR(end(channel, 75).tube_area_m2_per_sr,
              (1505 - 0.2 * sag) / 1505 * (1e4 + sag * sag) * (1 + y * y), 1e-6);
}

TEST(RayTrace, HorizontalRaysOnTheBorderOfUniformWaterBendIntoTheSlowerLayer) {
  const double radius = 1500 / 0.2, sag = radius - std::sqrt(radius * radius - 1e4);
  const auto end_depth_m = [](const std::vector<ProfilePoint>& points) {
    return trace_ray({SoundSpeedProfile(points), {}}, 50, 0, {.longest_range_m = 100}).back().state.depth_m;
  };
  EXPECT_NEAR(end_depth_m({{0, 1490}, {50, 1500}, {100, 1500}}), 50 - sag, 1e-9);
  EXPECT_NEAR(end_depth_m({{0, 1500}, {50, 1500}, {100, 1490}}), 50 + sag, 1e-9);
}

TEST(RayTrace, RefusesBadLaunches) {
  const WaterColumn water{SoundSpeedProfile(1500), {}};
  EXPECT_THROW(trace_ray(water, -1, 0, {.surface_m = 0}), std::invalid_argument);
  EXPECT_THROW(trace_ray(water, 30, 0, {.bottom_m = 20}), std::invalid_argument);
  EXPECT_THROW(trace_ray(water, 10, 90 * degree, {}), std::invalid_argument);
  EXPECT_THROW(trace_ray(water, 10, NAN, {}), std::invalid_argument);
  EXPECT_EQ(trace_ray(water, 10, 89 * degree,
                      {.surface_m = 0, .bottom_m = 20, .longest_range_m = 1e9, .most_nodes = 1000})
                .size(),
            1000u);
}

TEST(RayArc, ShortRangeTable) {
  // 20 m above the bottom, 1500 m/s at the sonar.
  const struct {
    double g, launch, range, time_ms, arrival;
  } rows[] = {{0, 10, 113.425636, NAN, 10},
              {0, 11, 102.891080, NAN, 11},
              {-0.1, 10, 111.019985060, 75.254728457, 10.424346065},
              {-0.1, 11, 101.070715957, 68.732720315, 11.386317780},
              {0.1, 10, 116.047077565, 78.452784299, 9.557030336},
              {0.1, 11, 104.844709818, 71.109291713, 10.599791142},
              {0.016, 10, 113.829649103, 77.040648428, 9.930439871},
              {0.016, 11, 103.194240002, 70.068834044, 10.936939059}};
  for (const auto& row : rows) {
    const double c1 = 1500, c2 = 1500 + 20 * row.g;
    const SnellRay ray{c1, std::sin(row.launch * degree), std::cos(row.launch * degree)};
    const double s2 = ray.sine_at(c2), reach = arc_reach(20, c1, c2, ray.sine, s2);
    EXPECT_NEAR(ray.p() * reach, row.range, row.g == 0 ? 6e-7 : 6e-10);
    EXPECT_NEAR(std::asin(s2) / degree, row.arrival, 6e-10);
    if (row.g != 0) {
      EXPECT_NEAR(1000 * arc_time_s(20, c1, c2, ray.sine, s2, ray.p()), row.time_ms, 6e-10);
    }
  }
}

TEST(RayArc, TubesOnTheBottomAtShortRange) {
  const struct {
    double g, area;
  } rows[] = {{0, 29.829429860}, {-0.1, 27.621765641}, {0.1, 32.391273697}, {0.016, 30.213453741}};
  for (const auto& row : rows) {
    const double c2 = 1500 + 20 * row.g;
    double x[2];
    for (int i = 0; i < 2; ++i) {
      const SnellRay ray{1500, std::sin((10 + i) * degree), std::cos((10 + i) * degree)};
      x[i] = ray.p() * arc_reach(20, 1500, c2, ray.sine, ray.sine_at(c2));
    }
    EXPECT_NEAR(1.5 * degree / 2 * (x[0] - x[1]) * (x[0] + x[1]), row.area, 6e-10);
  }
}

TEST(RayTrace, EndsWithTheLastPermittedReflection) {
  const auto nodes =
      trace_ray({SoundSpeedProfile(1500), {}}, 10, 45 * degree,
                {.surface_m = 0, .bottom_m = 20, .longest_range_m = 1e4, .most_reflections = 2});
  ASSERT_EQ(nodes.size(), 3U);
  EXPECT_EQ(nodes[1].event, RayEvent::bottom);
  EXPECT_EQ(nodes[2].event, RayEvent::surface);
  EXPECT_NEAR(nodes[2].state.range_m, 30, 1e-9);
}

}  // namespace
}  // namespace tubefoot
