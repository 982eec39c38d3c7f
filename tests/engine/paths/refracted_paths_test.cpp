// SPDX-License-Identifier: GPL-3.0-or-later
// Tests paths over mirrors in stratified water. The comparisons are isovelocity water, closed forms of one
// gradient, series of rays, reciprocity, and brute-force rays.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <map>
#include <numeric>
#include <random>

#include "engine/visibility/tube_engine.hpp"
#include "engine/water/apparent_map.hpp"
#include "fixtures/world/refracted_rays.hpp"

namespace tubefoot {
namespace {

using namespace test;

// Images by rays through isovelocity water equal the images by planes. Cuts of facets at the height of a
// mirror round corners to the grid (1e-6 m). This applies to all images or to those of this mirror.
TEST(RefractedPaths, IsovelocityWaterIsTheStraightEngine) {
  const WaterColumn even{SoundSpeedProfile({{0, c_ref}, {60, c_ref}}), {0.02, 0.02, 0.02}};
  for (const bool apart : {false, true}) {
    Setting s = furnished(apart);
    s.absorption_db_per_m = 0.02;
    s.paths.mirrors.surface->roughness = 0.8;
    const PathEcho straight = s.run(), refracted = through(water_of(even), s);
    EXPECT_EQ(refracted.arrivals, straight.arrivals);
    EXPECT_EQ(straight.arrivals, apart ? 2u : 0u);  // direct and over the surface
    for (std::size_t order = 0; order < straight.by_order.size(); ++order) {
      const double peak = *std::ranges::max_element(straight.by_order[order].energy);
      if (order > 1) {
        EXPECT_GT(peak, 0) << order;
      }
      for (std::size_t k = 0; k < straight.by_order[order].energy.size(); ++k)
        EXPECT_NEAR(refracted.by_order[order].energy[k], straight.by_order[order].energy[k],
                    3e-6 * straight.by_order[order].energy[k] + 1e-9 * peak)
            << apart << " order " << order << " sample " << k;
    }
  }
}

// The deviation is of first order: half of the gradient moves energies half as far from those of
// isovelocity water. The cells of the seabed are small enough for all gradients, so that all have the same
// cuts.
TEST(RefractedPaths, AGradientThatGoesToZeroLeavesTheImageSeries) {
  Setting s = under_surface(3);
  s.mesh = FacetMesh();
  for (double x = -80; x < 80; x += 10)
    for (double y = -80; y < 80; y += 10)
      add_quad(s.mesh, {x, y, -20}, {x + 10, y, -20}, {x + 10, y + 10, -20}, {x, y + 10, -20});
  const PathEcho straight = s.run();
  const auto at = [&](double g) {
    const WaterColumn column = gradient(g, 1500 - 5 * g);  // 1500 m/s at the sonar
    return through(water_of(column, 1), s);
  };
  const PathEcho whole = at(4e-3), half = at(2e-3), next_to_none = at(1e-9);
  for (const std::size_t order : {2, 3})
    for (const int k : {5, 12, 20}) {
      const auto moved = [&](const PathEcho& refracted) {
        return refracted.by_order[order].at(0, k) / straight.by_order[order].at(0, k) - 1;
      };
      EXPECT_GT(std::abs(moved(whole)), 1e-6) << order << ' ' << k;
      EXPECT_NEAR(moved(whole) / moved(half), 2, 0.03) << order << ' ' << k;
      EXPECT_LT(std::abs(moved(next_to_none)), 1e-8);
    }
}

// Mirror and seabed in one gradient: one leg goes over the surface and the other is direct, or both legs go
// over the surface. The comparison is rings of the seabed with rays in closed form.
TEST(RefractedPaths, SurfaceMultiplesOfAFlatSeabedInOneGradient) {
  for (const double g : {-0.6, 0.5}) {
    for (const double roughness : {0.0, 2.5}) {
      Setting s = under_surface(3);
      s.mesh = square_seabed(-20, 60);
      s.paths.mirrors.surface->roughness = roughness;
      const WaterColumn column = gradient(g, 1510);
      const PathEcho paths = through(water_of(column, 5e-4), s);
      const SurfaceMultiples rings{{1510, g}, roughness};
      for (const int k : {1, 5, 12, 18}) {
        const double from = 26 + k, one = rings.once(from, from + 1), two = rings.twice(from, from + 1);
        EXPECT_NEAR(paths.by_order[2].at(0, k), one, 2e-4 * one) << g << " sample " << k;
        EXPECT_NEAR(paths.by_order[3].at(0, k), two, 2e-4 * two) << g << " sample " << k;
      }
    }
  }
}

// A pattern about the vertical, different up and down, on the transmit leg only or on the receive leg only.
// One leg goes up to the surface, the other down.
TEST(RefractedPaths, PatternsAreTakenWhereRaysAreLaunched) {
  const Directivity tilted{Directivity::Kind::gaussian, {0, 0, 1}, true, 0, 1.5};
  Setting s = under_surface(3);
  s.mesh = square_seabed(-20, 60);
  const double g = -0.8;
  const WaterColumn column = gradient(g, 1510);
  const Circles circles{1510, g};
  BeamPatterns tx{{tilted}, {Directivity()}, {}, {}}, back{{TransmitPattern()}, {tilted}, {}, {}};
  for (BeamPatterns* patterns : {&tx, &back}) {
    patterns->fan_of_tube.assign(s.receive.tubes.size(), 0);
    patterns->beams_of_tube.assign(s.receive.tubes.size(), {0, 1});
    const PathEcho paths = through(water_of(column, 5e-4), s, patterns);
    // The total energy between two times, by integration over distance in small steps.
    std::vector<double> once(30), twice(30);
    constexpr int steps = 4000;
    for (int n = 0; n < steps; ++n) {
      const double width = 55.0 / steps, x = (n + 0.5) * width;
      const Circles::Ray a = circles.to(x, 5, {}, 20), b = circles.to(x, 5, {0}, 20);
      const double down = tilted.gain_at(-std::sin(a.launch)), up = tilted.gain_at(std::sin(b.launch)),
                   sines = std::sin(a.arrival) * std::sin(b.arrival);
      const double ring = 0.01 * 2 * pi * x * width;
      const double sent_down = 0.6 * ring * sines / (a.area * b.area_back),
                   sent_up = 0.6 * ring * sines / (b.area * a.area_back);
      const auto put = [&](std::vector<double>& into, double half_path_m, double energy) {
        const double k = half_path_m - s.samples.first_m;
        if (k >= 0 && k < 30) into[std::size_t(k)] += energy;
      };
      put(once, (a.t + b.t) / 2 * c_ref,
          patterns == &tx ? sent_down * down + sent_up * up : sent_down * up + sent_up * down);
      put(twice, b.t * c_ref, 0.36 * ring * std::pow(std::sin(b.arrival), 2) / (b.area * b.area_back) * up);
    }
    const auto sum = [](const auto& of, int from, int to) {
      double all = 0;
      for (int k = from; k < to; ++k) all += of(k);
      return all;
    };
    // The steps end within range bins, so that the test compares sums of several bins.
    for (const int from : {2, 10}) {
      const double one = sum([&](int k) { return once[std::size_t(k)]; }, from, from + 8),
                   two = sum([&](int k) { return twice[std::size_t(k)]; }, from, from + 8);
      EXPECT_NEAR(sum([&](int k) { return paths.by_order[2].at(0, k); }, from, from + 8), one, 3e-3 * one)
          << from;
      EXPECT_NEAR(sum([&](int k) { return paths.by_order[3].at(0, k); }, from, from + 8), two, 3e-3 * two)
          << from;
    }
  }
}

// In a channel, unscattered sound from a transmitter reaches a receiver 40 m away over surface and seabed.
TEST(RefractedPaths, AChannelIsASeriesOfRays) {
  constexpr int order = 4;
  Setting s;
  s.mesh = square_seabed(-20, 150);
  s.transmit = around({0, 0, -5}, -86, 86, 2, 180);
  s.receive = around({40, 0, -10}, -86, 86, 2, 180);
  s.samples = {15, 0.05, 1200};
  s.mu = {1e-12};
  s.reflection = {0.25};
  s.absorption_db_per_m = 0.01;
  s.paths.order = order;
  s.paths.cutoff_db = 300;
  s.paths.direct = true;
  s.paths.mirrors.surface = SeaSurface{0, 0.8, 0.3};
  const Circles circles{1490, 0.4};
  const WaterColumn column = gradient(0.4, 1490, 0.01);
  const PathEcho paths = through(water_of(column, 1), s);
  EXPECT_EQ(paths.arrivals, 1u + 2 * order);
  Setting certified = s;  // in range bins that contain one arrival each, with bounds
  certified.mesh = square_seabed(-20, 60);
  certified.paths.order = 2;
  certified.paths.reference_tolerance = 1e-3;
  certified.samples = {15, 2.5, 20};
  const PathEcho reference = through(water_of(column, 5e-2), certified);
  EXPECT_EQ(reference.arrivals, 5u);
  for (int n = 0; n <= order; ++n) {
    std::vector<double> expected(s.samples.count);
    for (int first = 0; first < (n == 0 ? 1 : 2); ++first) {
      std::vector<double> mirrors;
      double passes = 1;
      int rough = 0;
      for (int k = 0; k < n; ++k) {
        const bool at_surface = (first + k) % 2 == 0;
        mirrors.push_back(at_surface ? 0 : 20);
        rough += at_surface;
        passes *= at_surface ? 0.8 : 0.25;
      }
      Circles::Leg leg;
      double energy = 0;
      const Circles::Ray ray = circles.to(40, 5, mirrors, 10);
      leg = circles.over(ray.launch, 5, mirrors, 10);
      energy = passes * std::exp(-0.3 * rough * ray.mirror_sine * ray.mirror_sine) *
               std::pow(10, -0.001 * leg.s) / ray.area;
      expected[std::size_t((leg.t * c_ref / 2 - s.samples.first_m) / s.samples.step_m)] += energy;
    }
    for (std::size_t k = 0; n <= 2 && k < 20; ++k) {
      const double truth = std::accumulate(expected.begin() + 50 * std::ptrdiff_t(k),
                                           expected.begin() + 50 * std::ptrdiff_t(k) + 50, 0.0),
                   energy = reference.by_order[std::size_t(n)].energy[k],
                   bound = reference.bound_by_order[std::size_t(n)][k];
      if (!(truth > 0)) continue;  // energy that the seabed scatters
      EXPECT_LE(std::abs(energy - truth), bound + 1e-8 * truth) << "order " << n << " sample " << k;
      EXPECT_LT(bound, 1e-6 * truth) << "order " << n << " sample " << k;
    }
    double scattered = 0;
    for (int k = 0; k < s.samples.count; ++k) {
      const double energy = paths.by_order[n].at(0, k);
      if (expected[k] == 0)
        scattered += energy;
      else
        EXPECT_NEAR(energy, expected[k], 1e-8 * expected[k]) << "order " << n << " sample " << k;
    }
    EXPECT_LT(scattered, 1e-12) << n;
  }
}

// After an exchange of transmitter and receiver the energies differ by the square of the ratio of the sound
// speeds at the ends. Energy here is energy per square metre.
TEST(RefractedPaths, TransmitterAndReceiverExchangePlaces) {
  Setting s = furnished(true);
  Setting back = s;
  std::swap(back.transmit, back.receive);
  const WaterColumn column = gradient(-0.7, 1510);
  const PathWater water = water_of(column, 1e-3);
  const PathEcho there = through(water, s), rx = through(water, back);
  const double speeds = std::pow((1510 - 0.7 * 5) / (1510 - 0.7 * 7), 2);
  for (std::size_t order = 0; order < there.by_order.size(); ++order) {
    const double all = total(there.by_order[order]);
    EXPECT_GT(all, 0) << order;
    for (int k = 0; k < s.samples.count; ++k)
      EXPECT_NEAR(there.by_order[order].at(0, k), speeds * rx.by_order[order].at(0, k), 1e-7 * all)
          << order << ' ' << k;
  }
}

// With both legs over the surface, the echo equals that of a mirrored seabed in mirrored water.
TEST(RefractedPaths, ASurfaceIsItsImage) {
  Setting s = under_surface(3);
  s.mesh = FacetMesh();
  add_quad(s.mesh, {-90, -90, -20}, {90, -80, -22}, {90, 90, -23}, {-90, 90, -19});
  const double g = -0.5;
  const WaterColumn column = gradient(g, 1510),
                    mirrored{SoundSpeedProfile({{0, 1510 + 60 * g}, {60, 1510}, {120, 1510 + 60 * g}}),
                             {0, 0, 0, 0}};
  const PathEcho paths = through(water_of(column, 2e-4), s);

  FacetMesh above = s.mesh;
  for (GridPoint& v : above.vertices) v.z = -v.z;
  std::vector<FacetId> all{0, 1};
  const ApparentMap apparent_map(mirrored, {0, 0, -5}, 60, {}, c_ref);
  const ApparentSurface surface_mesh =
      map_apparent(above, all, grid, apparent_map, 0, {.travel_path_error_m = 2e-4});
  const std::vector<std::uint32_t> beam(s.transmit.tubes.size(), 0);
  EchoModel model{s.mu, surface_mesh.refined.mesh.material, 0, nullptr};
  model.path.facet_factor = surface_mesh.facet_factor;
  const SceneTree tree(surface_mesh.refined.mesh);
  const History history = TubeEngine(surface_mesh.refined.mesh, tree, unit, {}).trace(s.transmit);
  const Echo direct = integrate_echo(history, {1, beam}, s.samples, model);
  for (int k = 0; k < s.samples.count; ++k)
    EXPECT_NEAR(paths.by_order[3].at(0, k), 0.36 * direct.at(0, k), 3e-4 * 0.36 * direct.at(0, k)) << k;
}

// Rays are integrated in steps through the water and reflected. The rays of one gradient in closed form
// connect each insonified point to the sonar. The test also integrates these rays in steps, to find what
// hides them.
TEST(RefractedPaths, AgreeWithBruteForceRays) {
  const Setting s = furnished(false);
  const double g = -1.2;
  const Circles circles{1510, g};
  const WaterColumn column = gradient(g, 1510);
  const PathEcho paths = through(water_of(column, 5e-4), s);
  const Stepped rays{s, circles};
  const unsigned seed = 20;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> any(0, 1);
  constexpr int count = 12000, groups = 4;
  constexpr std::array<double, groups + 1> borders{4, 20, 28, 36, 44};
  const double top = std::sin(86 * pi / 180), whole = 2 * pi * 2 * top;
  const glm::dvec3 apex{0, 0, -5};
  const auto reflected = [&](int what) {
    return what == Stepped::surface ? 0.6 : s.reflection[s.mesh.material[std::size_t(what)]];
  };
  std::array<std::array<double, groups>, 4> sum{}, square{};
  for (int n = 0; n < count; ++n) {
    // Stratified sampling: each ray has its own band of elevations.
    const double z = top * (2 * (n + any(random)) / count - 1), azimuth = 2 * pi * any(random);
    const double flat = std::sqrt(1 - z * z);
    const auto met = rays.follow(apex, {flat * std::cos(azimuth), flat * std::sin(azimuth), z}, 2);
    std::array<std::array<double, groups>, 4> own{};
    double passed = 1;
    for (std::size_t there = 0; there < met.size(); ++there) {
      const Stepped::Meeting& lit = met[there];
      for (const std::vector<int>& chain : {std::vector<int>{}, {0}, {15}, {0, 15}, {15, 0}}) {
        const std::size_t order = there + chain.size() + 1;
        if (lit.what < 0 || order < 2 || order > 3) continue;
        std::vector<double> mirrors(chain.begin(), chain.end());
        const Circles::Ray back = circles.to(std::hypot(lit.at.x, lit.at.y), 5, mirrors, -lit.at.z);
        double elevation = back.launch;  // up, if the leg begins so
        if (chain.empty() ? lit.at.z < apex.z : chain.front() == 15) elevation = -elevation;
        if (std::abs(elevation) > 86 * pi / 180) continue;
        const double angle = std::atan2(lit.at.y, lit.at.x);
        const auto rx = rays.follow(apex,
                                    {std::cos(elevation) * std::cos(angle),
                                     std::cos(elevation) * std::sin(angle), std::sin(elevation)},
                                    int(chain.size()));
        if (rx.size() != chain.size() + 1 || rx.back().what != lit.what ||
            glm::distance(rx.back().at, lit.at) > 1e-3)
          continue;
        bool same = true;
        double passes = passed;
        for (std::size_t k = 0; k < chain.size(); ++k) {
          same = same && (rx[k].what == Stepped::surface) == (chain[k] == 0);
          passes *= reflected(rx[k].what);
        }
        const glm::dvec3 normal = rays.normal(lit.what);
        const double in = glm::dot(normal, lit.along), out = glm::dot(normal, rx.back().along);
        if (!same || in * out <= 0) continue;
        const double half = (lit.t + rx.back().t) / 2 * c_ref;
        const auto group = std::ranges::upper_bound(borders, half) - borders.begin();
        if (group < 1 || group > groups) continue;
        own[order][std::size_t(group - 1)] +=
            whole * passes * s.mu[s.mesh.material[std::size_t(lit.what)]] * std::abs(out) / back.area_back;
      }
      if (there + 1 < met.size()) passed *= reflected(lit.what);
    }
    for (std::size_t order = 2; order < 4; ++order)
      for (std::size_t k = 0; k < groups; ++k) {
        sum[order][k] += own[order][k] / count;
        square[order][k] += own[order][k] * own[order][k] / count;
      }
  }
  int compared = 0;
  for (std::size_t order = 2; order < 4; ++order)
    for (std::size_t k = 0; k < groups; ++k) {
      double energy = 0;
      for (double at_m = borders[k]; at_m < borders[k + 1]; ++at_m)
        energy += paths.by_order[order].at(0, int(at_m - s.samples.first_m));
      const double error = std::sqrt((square[order][k] - sum[order][k] * sum[order][k]) / count);
      if (error > 0.2 * sum[order][k]) continue;  // too few rays to estimate the error
      ++compared;
      EXPECT_NEAR(energy, sum[order][k], 4.5 * error + 1e-3 * sum[order][k])
          << "order " << order << " group " << k;
    }
  EXPECT_GE(compared, 6);
}

}  // namespace
}  // namespace tubefoot
