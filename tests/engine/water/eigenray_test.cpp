// SPDX-License-Identifier: GPL-3.0-or-later
// Tests eigenrays of layered water against published cases, closed forms of one gradient, Runge-Kutta
// integration, reciprocity, shadow zones and turning rays.

#include "engine/water/eigenray.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "engine/water/ray_trace.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

double launch_deg(const Eigenray& e) { return std::atan2(e.launch_sine, e.launch_cosine) / degree; }
double arrival_deg(const Eigenray& e) { return std::atan2(e.arrival_sine, e.arrival_cosine) / degree; }

WaterColumn sampled(const std::function<double(double)>& speed, double bottom_m, double step_m) {
  return {SoundSpeedProfile(sample_profile(speed, 0, bottom_m, step_m)), {}};
}

TEST(Eigenray, PublishedCaseOfOneGradient) {
  const WaterColumn water{SoundSpeedProfile({{0, 1500}, {5000, 1580}}), {}};
  const auto ray = EigenrayFinder(water, 1000).direct(1200, 5000);
  ASSERT_TRUE(ray);
  EXPECT_NEAR(launch_deg(*ray), 3.80042862, 6e-9);
  EXPECT_NEAR(arrival_deg(*ray), 0.78079146, 6e-9);
  EXPECT_NEAR(ray->length_m, 5004.57757, 6e-6);
  EXPECT_NEAR(ray->time_s, 3.296930051, 6e-10);
  EXPECT_NEAR(ray->tube_area_m2_per_sr, 25110315.1, 0.06);
  EXPECT_NEAR(10 * std::log10(ray->tube_area_m2_per_sr), 73.99852, 6e-6);
  const double cs = 1516, cr = 1519.2;
  EXPECT_NEAR(cs / ray->launch_cosine / 0.016, 94958.817, 6e-4);
  const double pressure = std::sqrt(cr / cs / ray->tube_area_m2_per_sr);
  EXPECT_NEAR(pressure, 1.99770701e-4, 6e-13);
  // The figures of the published ray code, whose steps differ in the fifth digit.
  EXPECT_NEAR(launch_deg(*ray), 3.80048, 6e-5);
  EXPECT_NEAR(ray->time_s, 3.29689956, 4e-5);
  EXPECT_NEAR(pressure, 1.99781e-4, 2e-8);
  // The wavefront is a sphere about a lower centre.
  const double g = 0.016, t = ray->time_s;
  EXPECT_NEAR(1000 + cs / g * (std::cosh(g * t) - 1), 1131.858873, 6e-7);
  EXPECT_NEAR(cs / g * std::sinh(g * t), 5000.464300, 6e-7);
}

// The ring of a range bin on a flat bottom, from the times of eigenrays alone.
TEST(Eigenray, RingAreasOfRangeBins) {
  const struct {
    double g, area, echo_ms;
  } rows[] = {{0, 0.130932419, 26.666666667},
              {-0.1, 0.130758811, 26.684460262},
              {0.016, 0.130960376, 26.663822627},
              {-1, 0.129282416, 26.846040664}};
  for (const auto& row : rows) {
    const WaterColumn water{SoundSpeedProfile({{0, 1500 - 10 * row.g}, {30, 1500 + 20 * row.g}}), {}};
    const EigenrayFinder finder(water, 10);
    EXPECT_NEAR(2000 * finder.direct(30, 0)->time_s, row.echo_ms, 1e-9);
    double x2[2];
    for (int i = 0; i < 2; ++i) {
      const double wanted = (100 + 0.05 * i) / 1500;
      double lo = 0, hi = 200;  // range of that travel time, by bisection
      while (hi - lo > 1e-12 * hi) {
        const double mid = (lo + hi) / 2;
        (finder.direct(30, mid)->time_s < wanted ? lo : hi) = mid;
      }
      x2[i] = lo * lo;
    }
    EXPECT_NEAR(1.5 * degree / 2 * (x2[1] - x2[0]), row.area, 1e-9) << row.g;
  }
}

TEST(Eigenray, LinearSquareOfIndexAsPublished) {
  const auto speed = [](double z) { return n2_linear_sound_speed_m_s(z, 1550, 1.2); };
  const WaterColumn water = sampled(speed, 1300, 0.25);
  const struct {
    double from, to, range, launch, arrival, time, by_grab_launch, by_grab_arrival;
  } rows[] = {{1000, 800, 3000, 40.603895, 35.900337, 2.844936, 40.6078, 35.9053},
              {75, 75, 500, 10.146492, 10.146492, 0.339048, 10.1467, 10.1467}};
  for (const auto& row : rows) {
    const auto rays = EigenrayFinder(water, row.from).all(row.to, row.range);
    const auto found = std::find_if(rays.begin(), rays.end(), [&](const Eigenray& e) {
      return std::abs(launch_deg(e) + row.launch) < 0.1;
    });
    ASSERT_NE(found, rays.end());
    EXPECT_EQ(found->turns, 1);
    EXPECT_NEAR(-launch_deg(*found), row.launch, 1e-4);
    EXPECT_NEAR(arrival_deg(*found), row.arrival, 1e-4);
    EXPECT_NEAR(found->time_s, row.time, 2e-6);
    EXPECT_NEAR(-launch_deg(*found) / row.by_grab_launch, 1, 1.1e-4);
    EXPECT_NEAR(arrival_deg(*found) / row.by_grab_arrival, 1, 1.5e-4);
  }
}

/// Makes a profile of up to `layers` layers over 200 m, with speeds of 1400 to 1600 m/s. Some layers are
/// isovelocity.
WaterColumn random_water(std::mt19937_64& random, int layers) {
  std::uniform_real_distribution<double> any(0, 1);
  std::vector<ProfilePoint> points = {{0, 1500}};
  for (int i = 1; i <= layers; ++i) {
    const double c = any(random) < 0.15 ? points.back().sound_speed_m_s : 1480 + 40 * any(random);
    points.push_back({points.back().depth_m + 200. / layers * (0.2 + 1.6 * any(random)), c});
  }
  WaterColumn water{SoundSpeedProfile(points), {}};
  for (std::size_t i = 0; i < water.profile.layers(); ++i) water.absorption_db_per_m.push_back(any(random));
  return water;
}

/// Computes range, time, length and absorption by RK4 in arc length, from the ray equations alone.
RayState by_runge_kutta(const WaterColumn& water, double depth_m, double launch_rad, double length_m) {
  const SoundSpeedProfile& profile = water.profile;
  struct Y {
    double x, z, theta, t;
  };
  const auto slope = [&](const Y& y, std::size_t layer) {
    const double g = profile.gradient_per_s(layer);
    const double c =
        layer == 0 || layer + 1 == profile.layers()
            ? profile.speed_in(layer, y.z)
            : profile.points()[layer].sound_speed_m_s + g * (y.z - profile.points()[layer].depth_m);
    return Y{std::cos(y.theta), std::sin(y.theta), -g * std::cos(y.theta) / c, 1 / c};
  };
  Y y{0, depth_m, launch_rad, 0};
  double s = 0, db = 0;
  std::size_t layer = profile.layer_at(depth_m);
  const auto stepped = [&](double h) {
    const auto plus = [](const Y& a, double k, const Y& b) {
      return Y{a.x + k * b.x, a.z + k * b.z, a.theta + k * b.theta, a.t + k * b.t};
    };
    const Y k1 = slope(y, layer), k2 = slope(plus(y, h / 2, k1), layer);
    const Y k3 = slope(plus(y, h / 2, k2), layer), k4 = slope(plus(y, h, k3), layer);
    return plus(plus(plus(plus(y, h / 6, k1), h / 3, k2), h / 3, k3), h / 6, k4);
  };
  for (double h = 0.5; s < length_m;) {
    h = std::min(0.5, length_m - s);
    Y next = stepped(h);
    const double top = profile.top_m(layer), bottom = profile.bottom_m(layer);
    const bool below = next.z > bottom, above = next.z < top;
    if (below || above) {  // a step ends at the border
      double lo = 0, hi = h;
      while (hi - lo > 1e-14) {
        const double mid = (lo + hi) / 2;
        const double z = stepped(mid).z;
        (z > bottom || z < top ? hi : lo) = mid;
      }
      h = hi;
      next = stepped(h);
    }
    db += water.absorption_in(layer) * h;
    y = next;
    s += h;
    if (below) ++layer;
    if (above) --layer;
  }
  RayState state;
  state.range_m = y.x;
  state.depth_m = y.z;
  state.sine = std::sin(y.theta);
  state.cosine = std::cos(y.theta);
  state.time_s = y.t;
  state.length_m = s;
  state.absorption_db = db;
  return state;
}

TEST(Eigenray, RandomWatersAgainstRungeKutta) {
  const unsigned seed = 7;
  SCOPED_TRACE(seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> any(0, 1);
  int direct = 0, turned = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const WaterColumn water = random_water(random, 1 + trial % 9);
    const double from = 150 * any(random), to = 150 * any(random);
    const double range = 1000 * std::pow(any(random), 2);
    const auto rays = EigenrayFinder(water, from, {.most_turns = 3}).all(to, range);
    for (const Eigenray& e : rays) {
      (e.turns == 0 ? direct : turned)++;
      EXPECT_NEAR(std::hypot(e.launch_sine, e.launch_cosine), 1, 1e-9);
      const double launch = std::atan2(e.launch_sine, e.launch_cosine);
      const RayState end = by_runge_kutta(water, from, launch, e.length_m);
      // Near a caustic or at grazing incidence on a layer border, a small change of launch angle has a
      // large effect.
      const double far = std::max(1., range / std::max(1e-3, std::abs(e.arrival_sine)) / 1000);
      EXPECT_NEAR(end.range_m, range, 1e-6 * far * (1 + range)) << trial << ' ' << e.turns;
      EXPECT_NEAR(end.depth_m, to, 1e-6 * far * (1 + range)) << trial << ' ' << e.turns;
      EXPECT_NEAR(end.time_s, e.time_s, 1e-9 * far) << trial;
      EXPECT_NEAR(end.sine, e.arrival_sine, 1e-6 * far) << trial;
      EXPECT_NEAR(end.absorption_db, e.absorption_db, 1e-5 * far * (1 + e.absorption_db)) << trial;
    }
  }
  EXPECT_GT(direct, 200);
  EXPECT_GT(turned, 40);
}

TEST(Eigenray, TubeAreasAreDerivativesOfRange) {
  const unsigned seed = 11;
  SCOPED_TRACE(seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> any(0, 1);
  int checked = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const WaterColumn water = random_water(random, 1 + trial % 9);
    const double from = 150 * any(random), to = 150 * any(random), range = 10 + 500 * any(random);
    const EigenrayFinder finder(water, from);
    const double step = 1e-4;
    for (const Eigenray& e : finder.all(to, range)) {
      double launch[2];
      int found = 0;
      for (const double side : {-1., 1.}) {
        for (const Eigenray& n : finder.all(to, range + side * step)) {
          const double angle = std::atan2(n.launch_sine, n.launch_cosine);
          if (n.turns == e.turns && std::abs(angle - launch_deg(e) * degree) < 1e-4)
            launch[side > 0] = angle, ++found;
        }
      }
      if (found != 2 || std::abs(e.launch_sine) < 0.02 || std::abs(e.arrival_sine) < 0.02) continue;
      const double area =
          range * std::abs(e.arrival_sine) * (2 * step / std::abs(launch[1] - launch[0])) / e.launch_cosine;
      EXPECT_NEAR(area / e.tube_area_m2_per_sr, 1, 2e-4) << trial << ' ' << e.turns;
      ++checked;
    }
  }
  EXPECT_GT(checked, 150);
}

TEST(Eigenray, IsReciprocal) {
  const unsigned seed = 3;
  SCOPED_TRACE(seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> any(0, 1);
  int rays = 0;
  for (int trial = 0; trial < 600; ++trial) {
    const WaterColumn water = random_water(random, 1 + trial % 12);
    const double a = 150 * any(random), b = 150 * any(random), range = 800 * any(random);
    const auto there = EigenrayFinder(water, a).all(b, range), back = EigenrayFinder(water, b).all(a, range);
    ASSERT_EQ(there.size(), back.size()) << trial;
    const double ca = water.profile.at(a), cb = water.profile.at(b);
    for (std::size_t i = 0; i < there.size(); ++i) {
      EXPECT_NEAR(there[i].time_s, back[i].time_s, 1e-11);
      EXPECT_NEAR(there[i].tube_area_m2_per_sr * ca * ca / (back[i].tube_area_m2_per_sr * cb * cb), 1, 1e-6);
      EXPECT_NEAR(there[i].launch_sine, -back[i].arrival_sine, 1e-8);
      ++rays;
    }
  }
  EXPECT_GT(rays, 500);
}

// The same water cut into more layers has the same rays.
TEST(Eigenray, DoesNotDependOnHowALayerIsCut) {
  const auto speed = [](double z) { return 1500 + 0.05 * z; };
  const WaterColumn one = sampled(speed, 400, 400), many = sampled(speed, 400, 7);
  for (const double to : {10., 100., 117., 250.}) {
    for (const double range : {0., 1e-9, 1., 30., 500., 2000.}) {
      const auto a = EigenrayFinder(one, 100).all(to, range), b = EigenrayFinder(many, 100).all(to, range);
      ASSERT_EQ(a.size(), b.size()) << to << ' ' << range;
      for (std::size_t i = 0; i < a.size(); ++i) {
        EXPECT_NEAR(a[i].time_s, b[i].time_s, 1e-12);
        EXPECT_NEAR(a[i].launch_sine, b[i].launch_sine, 1e-10);
        EXPECT_NEAR(a[i].arrival_sine, b[i].arrival_sine, 1e-10);
        EXPECT_NEAR(a[i].length_m, b[i].length_m, 1e-9);
        EXPECT_NEAR(a[i].tube_area_m2_per_sr, b[i].tube_area_m2_per_sr, 1e-8 * (1 + range * range));
      }
    }
  }
}

TEST(Eigenray, IsovelocityWaterIsStraight) {
  const WaterColumn water{SoundSpeedProfile({{0, 1480}, {30, 1480}, {100, 1480}}), {}};
  const EigenrayFinder finder(water, 10);
  for (const double to : {0., 10., 20., 50., 300.}) {
    for (const double range : {0.5, 30., 4000.}) {
      const auto rays = finder.all(to, range);
      ASSERT_EQ(rays.size(), 1u);
      const double r = std::hypot(range, to - 10);
      EXPECT_NEAR(rays[0].time_s, r / 1480, 1e-14 * r);
      EXPECT_NEAR(rays[0].tube_area_m2_per_sr, r * r, 1e-9 * r * r);
      EXPECT_NEAR(rays[0].launch_sine, (to - 10) / r, 1e-13);
      EXPECT_NEAR(rays[0].length_m, r, 1e-11 * r);
    }
  }
}

TEST(Eigenray, ShadowZonesHaveNoRay) {
  // The speed decreases from 50 m in both directions, so that rays diverge there.
  const WaterColumn water{SoundSpeedProfile({{0, 1495}, {50, 1500}, {100, 1495}}), {}};
  const EigenrayFinder finder(water, 40);
  EXPECT_EQ(finder.all(60, 100).size(), 1u);
  // The ray that grazes the depth of the highest speed has the range (sin 1 + sin 2) / (p |g|).
  const double edge = 2 * std::sqrt((1500 - 1499) * (1500 + 1499.)) / 0.1;
  EXPECT_EQ(finder.all(60, edge * (1 - 1e-9)).size(), 1u);
  EXPECT_EQ(finder.all(60, edge * (1 + 1e-9)).size(), 0u);
  EXPECT_EQ(finder.all(60, 10 * edge).size(), 0u);
}

TEST(Eigenray, SeveralRaysWhereTheyCross) {
  // The gradient is strong below the source and weak above: rays that turn low overtake those that turn
  // high.
  const WaterColumn water{SoundSpeedProfile({{0, 1500}, {100, 1500.5}, {200, 1540}}), {}};
  const auto rays = EigenrayFinder(water, 20).all(20, 3000);
  EXPECT_GE(rays.size(), 2u);
  for (const Eigenray& e : rays) {
    const auto nodes =
        trace_ray(water, 20, std::atan2(e.launch_sine, e.launch_cosine), {.longest_range_m = 3000});
    EXPECT_NEAR(nodes.back().state.depth_m, 20, 1e-6);
    EXPECT_NEAR(nodes.back().state.time_s, e.time_s, 1e-9);
    EXPECT_NEAR(nodes.back().state.tube_area_m2_per_sr / e.tube_area_m2_per_sr, 1, 1e-6);
  }
}

TEST(Eigenray, NoRayTurnsOutsideOfTheWater) {
  const WaterColumn water{SoundSpeedProfile({{-100, 1520}, {100, 1500}}), {}};
  EXPECT_EQ(EigenrayFinder(water, 1).all(1, 2000).size(), 0u);
  EXPECT_EQ(EigenrayFinder(water, 1, {.surface_m = -100}).all(1, 2000).size(), 1u);
  EXPECT_THROW(EigenrayFinder(water, -1), std::invalid_argument);
}

// The test follows rays from the source. No ray that has turned reaches a point for which
// `may_turn_towards` excludes it.
TEST(Eigenray, RaysThatTurnAreExpectedWhereTheyPass) {
  std::size_t turned = 0;
  for (unsigned seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 engine(seed);
    const auto between = [&](double a, double b) { return std::uniform_real_distribution<>(a, b)(engine); };
    std::vector<ProfilePoint> points{{0, between(1450, 1540)}};
    while (points.size() < 12)
      points.push_back(
          {points.back().depth_m + between(0.5, 6), points.back().sound_speed_m_s + between(-8, 8)});
    const WaterColumn water{SoundSpeedProfile(points), {}};
    const double source_m = between(0.2, points.back().depth_m - 0.2);
    const EigenrayFinder finder(water, source_m, {0, points.back().depth_m, 1});
    const std::size_t layer = water.profile.layer_at(source_m);
    for (int k = -60; k <= 60; ++k) {
      int turns = 0;
      const double steepest = 0.25;
      for (const RayNode& node : trace_ray(water, source_m, steepest * k * std::abs(k) / 3600,
                                           {0, points.back().depth_m, 400, 100'000})) {
        turns += node.turned_at_m.has_value();
        if (node.event == RayEvent::surface || node.event == RayEvent::bottom || turns > 1) break;
        const double depth_m = node.state.depth_m;
        const bool in_its_layer =
            depth_m >= water.profile.top_m(layer) && depth_m <= water.profile.bottom_m(layer);
        if (turns == 0 || in_its_layer) continue;
        ++turned;
        EXPECT_TRUE(finder.may_turn_towards(depth_m, node.state.range_m))
            << depth_m << ' ' << node.state.range_m;
      }
    }
  }
  EXPECT_GT(turned, 10'000u);
}

TEST(Eigenray, WhereNoneCanTurnNoneIsLookedFor) {
  // The summer water of a shallow sea: the horizontal ray reaches a depth of 18 m at about 70 m.
  const WaterColumn water{
      SoundSpeedProfile({{0, 1527}, {6, 1519}, {8, 1508}, {10, 1499}, {13, 1494}, {35, 1490}}), {}};
  const EigenrayFinder finder(water, 8, {0, 25, 1});
  for (double range_m = 1; range_m < 55; range_m += 1) EXPECT_FALSE(finder.may_turn_towards(18, range_m));
  EXPECT_TRUE(finder.may_turn_towards(18, 400));
  // Isovelocity water turns no ray. A deep channel turns rays on both sides.
  const WaterColumn even{SoundSpeedProfile(1500), {}};
  EXPECT_FALSE(EigenrayFinder(even, 8).may_turn_towards(18, 1e5));
}

}  // namespace
}  // namespace tubefoot
