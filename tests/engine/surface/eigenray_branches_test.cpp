// SPDX-License-Identifier: GPL-3.0-or-later
// Tests several eigenrays to the seabed. Under a thermocline that turns rays downwards, three eigenrays
// reach each point beyond about 310 m. One gradient above the sonar and isovelocity water below give closed
// forms by launch angle. The test traces a fan of rays over launch angles and bins them by position and
// time on the seabed.
#include "engine/surface/eigenray_branches.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <memory>
#include <numeric>
#include <random>

#include "engine/echo/echo.hpp"
#include "engine/visibility/mixed_eigenrays.hpp"
#include "engine/visibility/tube_engine.hpp"
#include "engine/water/apparent_map.hpp"
#include "engine/water/ray_trace.hpp"
#include "fixtures/geometry/metre_meshes.hpp"
#include "fixtures/world/turning_water.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

using namespace test;

constexpr double branch_mu = 1e-3;
constexpr double half_fan = 1 * degree;

/// A strip of the seabed, in cells. The apex is the origin.
FacetMesh strip(double from_m, double to_m, double cell_m) {
  std::vector<std::array<glm::dvec3, 3>> facets;
  for (double x = from_m; x < to_m; x += cell_m)
    for (const double y : {-cell_m, 0.0}) {
      const double z = -TurningWater::seabed_m;
      facets.push_back({{{x, y, z}, {x + cell_m, y, z}, {x + cell_m, y + cell_m, z}}});
      facets.push_back({{{x, y, z}, {x + cell_m, y + cell_m, z}, {x, y + cell_m, z}}});
    }
  return mesh_of(facets);
}

/// Tubes of one azimuth, one beam per tube, with elevations from the horizontal upwards.
TubeSet tubes_of(const std::vector<double>& elevations_deg) {
  AngularGrid angles;
  angles.azimuth_edges_rad = {pi / 2 - half_fan, pi / 2 + half_fan};
  for (const double e : elevations_deg) angles.elevation_edges_rad.push_back(e * degree);
  angles.frame = glm::dmat3(glm::dvec3(0, 1, 0), glm::dvec3(1, 0, 0), glm::dvec3(0, 0, 1));
  TubeSet set;
  set.reach = 1e12;
  append_tubes(set, angles);
  return set;
}

ApparentMapSettings fine(double shortest_m = 0.25) {
  return {.travel_path_error_m = 0.02,
          .tolerance_db = 0.1,
          .shortest_edge_m = shortest_m,
          .shadow_edge_m = 8,
          .later_arrivals = true};
}

struct Seen {
  ApparentSurface surface_mesh;
  History history;
  Echo echo;
};

Seen see(const FacetMesh& seabed, const TubeSet& tubes, const RangeSamples& samples,
         const ApparentMapSettings& settings, int turns = 1) {
  static const WaterColumn water = TurningWater::column();
  EigenrayOptions options;
  options.most_turns = turns;
  options.frequency_hz = TurningWater::frequency_hz;
  const ApparentMap apparent_map(water, glm::dvec3(0), TurningWater::sonar_depth_m, options);
  std::vector<FacetId> all(seabed.facets.size());
  std::iota(all.begin(), all.end(), 0u);
  Seen seen{map_apparent(seabed, all, WorldGrid(20, glm::dvec3(0)), apparent_map, 0, settings), {}, {}};
  const FacetMesh& mesh = seen.surface_mesh.refined.mesh;
  const SceneTree tree(mesh, SceneTree::HeightFieldSearch::ignored);
  seen.history = TubeEngine(mesh, tree, 0x1p-20, {}).trace(tubes);
  const std::vector<double> material_mu{branch_mu};
  EchoModel model{material_mu, mesh.material, 0, nullptr};
  model.path.facet_factor = seen.surface_mesh.facet_factor;
  std::vector<std::uint32_t> beams(tubes.tubes.size());
  std::iota(beams.begin(), beams.end(), 0u);
  seen.echo = integrate_echo(seen.history, {int(beams.size()), beams}, samples, model);
  return seen;
}

double solid_angle(double low_deg, double high_deg) {
  return 2 * half_fan * (std::sin(high_deg * degree) - std::sin(low_deg * degree));
}

std::vector<double> solid_angles(const Seen& seen) {
  std::vector<double> sum(seen.history.tubes.tubes.size(), 0.0);
  for (const Footprint& footprint : seen.history.footprints.footprints)
    sum[footprint.tube] += footprint.solid_angle_sr;
  return sum;
}

const std::vector<double> elevations{-5, -4, -3.4, 4, 5, 6, 7, 7.2, 7.6, 8, 9, 10, 11, 12, 13, 14};

// Each direction is one ray, and each ray that reaches the seabed does so on one branch. Nothing is missing
// or double at the caustic, where two branches meet.
TEST(EigenrayBranches, WhatIsSentIsWhatLands) {
  const FacetMesh seabed = strip(200, 440, 40);
  const Seen seen = see(seabed, tubes_of(elevations), {0, 500, 1}, fine());
  const std::vector<double> found = solid_angles(seen);
  for (std::size_t k = 0; k + 1 < elevations.size(); ++k) {
    if (elevations[k] == -3.4) continue;  // between these, rays pass over the strip
    // Azimuth edges are planes. Chords of branches cut corners at their ends.
    EXPECT_NEAR(found[k] / solid_angle(elevations[k], elevations[k + 1]), 1, 3e-4) << elevations[k];
  }
  EXPECT_GT(seen.surface_mesh.facets_of_several, 0u);
  EXPECT_GT(seen.surface_mesh.facets_folded, 0u);
}

// The energy per beam and range bin is the transmitted energy, scattered once, times the area of the tube
// on the receive leg.
TEST(EigenrayBranches, EnergiesAreThoseOfAFanOfRays) {
  const FacetMesh seabed = strip(200, 440, 40);
  const RangeSamples samples{0, 5, 100};
  const Seen seen = see(seabed, tubes_of(elevations), samples, fine());
  double later = 0, wanted_later = 0;
  for (std::size_t beam = 0; beam + 1 < elevations.size(); ++beam) {
    if (elevations[beam] == -3.4) continue;
    constexpr int rays = 20000;
    std::vector<double> wanted(std::size_t(samples.count), 0.0);
    double all = 0, sum = 0;
    for (int i = 0; i < rays; ++i) {
      const double low = elevations[beam], step = (elevations[beam + 1] - low) / rays;
      const TurningWater::Landing ray = TurningWater::landing(-(low + (i + 0.5) * step) * degree);
      const double energy = branch_mu * std::sin(ray.arrival_rad) / ray.area_back_m2 *
                            solid_angle(low + i * step, low + (i + 1) * step);
      const double sample = (1500 * ray.time_s - samples.first_m) / samples.step_m;
      wanted[std::size_t(sample)] += energy;
      all += energy;
    }
    for (int k = 0; k < samples.count; ++k) {
      const double found = seen.echo.energy[beam * std::size_t(samples.count) + std::size_t(k)];
      sum += found;
      EXPECT_NEAR(found, wanted[std::size_t(k)], 0.03 * all) << elevations[beam] << ' ' << k;
    }
    // There is one factor per facet, and beams end on facets.
    EXPECT_NEAR(sum / all, 1, 0.03) << elevations[beam];
    if (elevations[beam] < 0) continue;
    later += sum;
    wanted_later += all;
  }
  EXPECT_NEAR(later / wanted_later, 1, 0.01);
}

/// Returns the rays to a point with launch angles positive downwards, in the range of the fan.
std::vector<double> launches_to(double x) {
  std::vector<double> launch{std::atan(TurningWater::seabed_m / x)};
  const double a = 2 * TurningWater::c / TurningWater::g, root2 = x * x - 4 * a * TurningWater::seabed_m;
  if (root2 > 0)
    for (const double sign : {-1.0, 1.0}) {
      const double up = std::atan((x + sign * std::sqrt(root2)) / (2 * a));
      if (up < TurningWater::steepest_rad) launch.push_back(-up);
    }
  std::erase_if(launch, [](double l) { return l < -14 * degree || l > 5 * degree; });
  return launch;
}

// The transmit leg is one ray and the receive leg another, in both orders, point by point on the seabed.
TEST(EigenrayBranches, MixedEigenraysAreThoseBetweenAllRaysToAPlace) {
  const FacetMesh seabed = strip(200, 440, 40);
  const RangeSamples samples{0, 5, 100};
  const TubeSet tubes = tubes_of(elevations);
  const Seen seen = see(seabed, tubes, samples, fine());
  const std::size_t beams = tubes.tubes.size(), count = std::size_t(samples.count);
  std::vector<double> found(beams * count, 0.0), wanted(beams * count, 0.0);
  const SceneTree tree(seen.surface_mesh.refined.mesh, SceneTree::HeightFieldSearch::ignored);
  const std::vector<double> material_mu{branch_mu};
  std::vector<std::uint32_t> own(beams);
  std::iota(own.begin(), own.end(), 0u);
  int histories = 0;
  trace_mixed_eigenrays(seen.surface_mesh, tree, WorldGrid(20, glm::dvec3(0)), {}, tubes,
                        [&](const BistaticHistory& history) {
                          const EchoModel model{material_mu, seen.surface_mesh.part_material, 0, nullptr};
                          const Echo echo = integrate_echo(history, {int(beams), own}, samples, model);
                          for (std::size_t k = 0; k < found.size(); ++k) found[k] += echo.energy[k];
                          ++histories;
                        });
  EXPECT_GE(histories, 6);
  constexpr int places = 400000;
  for (int i = 0; i < places; ++i) {
    const double step = 240.0 / places, x = 200 + (i + 0.5) * step;
    const std::vector<double> launch = launches_to(x);
    for (const double tx : launch)
      for (const double rx : launch) {
        if (tx == rx) continue;
        const TurningWater::Landing sent = TurningWater::landing(tx), received = TurningWater::landing(rx);
        std::size_t beam = 0;
        while (beam + 2 < elevations.size() && -rx / degree > elevations[beam + 1]) ++beam;
        const double sample = 1500 * (sent.time_s + received.time_s) / 2 / samples.step_m;
        wanted[beam * count + std::size_t(sample)] += branch_mu * std::sin(sent.arrival_rad) *
                                                      std::sin(received.arrival_rad) * x * 2 * half_fan *
                                                      step / (sent.area_back_m2 * received.area_back_m2);
      }
  }
  const double all = std::reduce(wanted.begin(), wanted.end()), most = *std::ranges::max_element(wanted);
  EXPECT_NEAR(std::reduce(found.begin(), found.end()) / all, 1, 0.02);
  for (std::size_t k = 0; k < found.size(); ++k) EXPECT_NEAR(found[k], wanted[k], 0.05 * most) << k;
}

// If one ray leads to the seabed, a larger number of requested rays changes nothing.
TEST(EigenrayBranches, OneRayIsOneSheet) {
  const FacetMesh seabed = strip(80, 280, 40);
  ApparentMapSettings one = fine();
  one.later_arrivals = false;
  const Seen all = see(seabed, tubes_of({-12, -5}), {0, 500, 1}, fine()),
             first = see(seabed, tubes_of({-12, -5}), {0, 500, 1}, one);
  EXPECT_EQ(all.surface_mesh.refined.mesh.vertices, first.surface_mesh.refined.mesh.vertices);
  EXPECT_EQ(all.surface_mesh.refined.mesh.facets, first.surface_mesh.refined.mesh.facets);
  EXPECT_EQ(all.surface_mesh.facet_factor, first.surface_mesh.facet_factor);
  EXPECT_EQ(all.echo.energy, first.echo.energy);
}

// The finder has as many rays as a fine fan, with a caustic crossed where the fan turns back.
TEST(EigenrayBranches, FamiliesAreThoseOfAFineFan) {
  const WaterColumn water = TurningWater::column();
  const ApparentMap apparent_map(water, glm::dvec3(0), TurningWater::sonar_depth_m);
  for (double x = 250.5; x < 440; x += 7) {
    std::vector<std::pair<double, bool>> fan;  // launch angle, caustic crossed: from the highest
    constexpr int rays = 200000;
    const double steepest = TurningWater::steepest_rad;
    TurningWater::Landing before{};
    double at_before = 0;
    for (int i = 0; i <= rays; ++i) {
      const double launch = -steepest + (steepest + 0.3) * i / rays;
      if (std::abs(launch) < 1e-3) {
        before = {};
        continue;
      }
      const TurningWater::Landing ray = TurningWater::landing(launch);
      if (before.range_m > 0 && (before.range_m - x) * (ray.range_m - x) <= 0)
        fan.emplace_back((at_before + launch) / 2, ray.range_m > before.range_m);
      before = ray;
      at_before = launch;
    }
    const std::vector<ApparentPoint> found = apparent_map.all_apparent({x, 0, -TurningWater::seabed_m});
    ASSERT_EQ(found.size(), fan.size()) << x;
    for (std::size_t k = 0; k < fan.size(); ++k) {
      const Eigenray& ray = found[k].ray;
      EXPECT_NEAR(std::atan2(ray.launch_sine, ray.launch_cosine), fan[k].first, 1e-5) << x;
      EXPECT_EQ(ray.crossed, fan[k].second) << x << ' ' << k;
    }
  }
}

/// A sound channel with its axis at 50 m, and a sonar 10 m above the axis.
WaterColumn channel() { return {SoundSpeedProfile({{0, 1550}, {50, 1500}, {100, 1550}}), {}}; }
constexpr double channel_sonar_m = 40, wall_m = 600;

// Rays turn up to four times before they reach a wall across the channel. At each depth there are as many
// as a separately traced fan has, and all transmitted energy arrives.
TEST(EigenrayBranches, AWallAcrossAChannelIsSeenByManyTurns) {
  const WaterColumn water = channel();
  EigenrayOptions options;
  options.most_turns = 4;
  options.deepest_turn_m = 100;
  const ApparentMap apparent_map(water, glm::dvec3(0), channel_sonar_m, options);
  const auto depth_at_wall = [&](double launch_rad) {
    return trace_ray(water, channel_sonar_m, launch_rad, {.longest_range_m = wall_m}).back().state.depth_m;
  };
  constexpr int rays = 20000;
  std::vector<double> depth;
  const double steepest = std::acos(1510. / 1549.9), step = 2 * steepest / rays;  // before the surface
  for (int i = 0; i <= rays; ++i) depth.push_back(depth_at_wall(-steepest + (i + 1e-3) * step));
  std::size_t most = 0;
  for (double z = 8.3; z < 92; z += 1.7) {
    std::size_t wanted = 0;
    for (int i = 0; i < rays; ++i)
      wanted += (depth[std::size_t(i)] - z) * (depth[std::size_t(i) + 1] - z) <= 0;
    std::size_t found = 0;  // of those, and steeper ones fall or rise along the whole path
    for (const ApparentPoint& point : apparent_map.all_apparent({wall_m, 0, channel_sonar_m - z}))
      found += std::abs(point.ray.launch_sine) < std::sin(steepest);
    EXPECT_EQ(found, wanted) << z;
    most = std::max(most, found);
  }
  EXPECT_GE(most, 3u);

  std::vector<std::array<glm::dvec3, 3>> facets;
  for (double z = 5; z < 95; z += 10)
    for (const double y : {-20.0, 0.0}) {
      const glm::dvec3 corner(wall_m, y, channel_sonar_m - z), up(0, 0, -10), left(0, 20, 0);
      facets.push_back({{corner, corner + left, corner + left + up}});
      facets.push_back({{corner, corner + left + up, corner + up}});
    }
  const FacetMesh wall = mesh_of(facets);
  std::vector<FacetId> all(wall.facets.size());
  std::iota(all.begin(), all.end(), 0u);
  const ApparentSurface surface_mesh =
      map_apparent(wall, all, WorldGrid(20, glm::dvec3(0)), apparent_map, 0, fine(1));
  std::vector<double> edges;
  for (int e = -8; e <= 8; ++e) edges.push_back(e);
  Seen seen{surface_mesh, {}, {}};
  const SceneTree tree(surface_mesh.refined.mesh, SceneTree::HeightFieldSearch::ignored);
  seen.history = TubeEngine(surface_mesh.refined.mesh, tree, 0x1p-20, {}).trace(tubes_of(edges));
  const std::vector<double> found = solid_angles(seen);
  for (std::size_t k = 0; k + 1 < edges.size(); ++k)
    EXPECT_NEAR(found[k] / solid_angle(edges[k], edges[k + 1]), 1, 1e-3) << edges[k];
}

// Compares the tube area that diffraction leaves on the caustic with the second derivative of the fan.
TEST(EigenrayBranches, CausticsAreAsWideAsAirysFunction) {
  const WaterColumn water = TurningWater::column();
  EigenrayOptions options;
  options.frequency_hz = TurningWater::frequency_hz;
  const EigenrayFinder finder(water, TurningWater::sonar_depth_m, options);
  int compared = 0;
  for (const double x : {311.0, 315.0, 330.0})
    for (const Eigenray& ray : finder.all(TurningWater::sonar_depth_m + TurningWater::seabed_m, x)) {
      if (ray.turns == 0) continue;
      const double wanted = TurningWater::caustic_area_m2(std::asin(ray.launch_sine));
      EXPECT_NEAR(ray.caustic_area_m2_per_sr / wanted, 1, 1e-3) << x;
      ++compared;
    }
  EXPECT_EQ(compared, 6);
}

TEST(EigenrayBranches, MeanInverseWidthIsTheIntegral) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> any(0, 1);
  for (int trial = 0; trial < 40; ++trial) {
    const double least = trial % 4 == 0 ? 1e-3 : any(random);
    std::array<double, 3> w{any(random), any(random), any(random)};
    if (trial % 3 == 0) w[0] = 0;
    if (trial % 5 == 0) w[1] = w[0];
    if (trial % 7 == 0) w = {w[0], w[0] + 1e-4 * w[1], w[0] + 1e-4 * w[2]};
    // Midpoints of a uniform grid, in which the second half of the triangles has the opposite orientation.
    constexpr int n = 700;
    double sum = 0;
    for (int i = 0; i < n; ++i)
      for (int j = 0; i + j < n; ++j)
        for (const double third : {1 / 3., 2 / 3.}) {
          if (third > 0.5 && i + j + 2 > n) continue;
          const double u = (i + third) / n, v = (j + third) / n;
          sum += 1 / std::hypot((1 - u - v) * w[0] + u * w[1] + v * w[2], least) / n / n;
        }
    for (const double sign : {1.0, -1.0})
      EXPECT_NEAR(mean_inverse_width({sign * w[0], sign * w[1], sign * w[2]}, least) / sum, 1, 3e-4) << trial;
  }
  EXPECT_EQ(mean_inverse_width({0, 0, 0}, 0), 0);
}

TEST(EigenrayBranches, RaysThatStayKeepTheirOrder) {
  const auto rays = [](std::initializer_list<std::pair<double, bool>> of) {
    std::vector<SeenPoint> points;
    for (const auto& [launch, crossed] : of) {
      SeenPoint point;
      point.launch_rad = launch;
      point.width = crossed ? -1 : 1;
      points.push_back(point);
    }
    return points;
  };
  using Same = std::vector<std::size_t>;
  const auto three = rays({{-0.2, false}, {-0.1, true}, {0.1, false}});
  EXPECT_EQ(same_rays(three, three), (Same{0, 1, 2}));
  EXPECT_EQ(same_rays(three, rays({{0.08, false}})), (Same{2}));
  EXPECT_EQ(same_rays(three, rays({{-0.18, false}})), (Same{0}));
  EXPECT_EQ(same_rays(three, rays({{-0.1, true}, {0.1, false}})), (Same{1, 2}));
  EXPECT_TRUE(same_rays(three, rays({{-0.1, true}, {0.1, true}})).empty());
  EXPECT_TRUE(same_rays(three, {}).empty());
}

}  // namespace
}  // namespace tubefoot
