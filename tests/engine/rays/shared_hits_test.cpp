// SPDX-License-Identifier: GPL-3.0-or-later
// Tests ray hits with a separate receiver. The comparisons are the tube engine and the ray hits of a
// monostatic sonar.
#include "engine/rays/shared_hits.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <functional>
#include <memory>
#include <numeric>
#include <random>

#include "engine/echo/echo.hpp"
#include "engine/scattering/perlin_reflectivity.hpp"
#include "engine/surface/facet_flattening.hpp"
#include "engine/water/apparent_map.hpp"
#include "fixtures/world/ray_scenes.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

double total(const Echo& echo) { return std::accumulate(echo.energy.begin(), echo.energy.end(), 0.0); }

/// A wavy seabed in cells of a metre, and a plate that stands on it.
FacetMesh wavy_seabed() {
  FacetMesh mesh;
  const auto at = [](double x, double y) {
    return glm::dvec3(x, y, -4 + 0.2 * std::sin(1.3 * x) * std::cos(0.9 * y));
  };
  for (int i = -8; i < 8; ++i)
    for (int j = 0; j < 16; ++j) {
      add_facet(mesh, at(i, j), at(i + 1, j), at(i + 1, j + 1));
      add_facet(mesh, at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
  add_rectangle(mesh, {0.5, 6, -4.5}, {1, 0.3, 0}, {0, 0, 2});
  return mesh;
}

/// A fan of `across` x `along` tubes that looks down along +y.
TubeSet fan(glm::dvec3 apex_m, int across, int along, double width_deg, double height_deg,
            double tilt_deg = 30) {
  AngularGrid sector;
  for (int k = 0; k <= across; ++k)
    sector.azimuth_edges_rad.push_back((double(k) / across - 0.5) * width_deg * degree);
  for (int k = 0; k <= along; ++k)
    sector.elevation_edges_rad.push_back((double(k) / along - 0.5) * height_deg * degree);
  const double c = std::cos(tilt_deg * degree), s = std::sin(tilt_deg * degree);
  sector.frame = glm::dmat3(glm::dvec3(0, c, -s), glm::dvec3(1, 0, 0), glm::dvec3(0, s, c));
  TubeSet tubes;
  tubes.apex = grid.snap(apex_m);
  tubes.reach = 100 / grid.unit_m();
  append_tubes(tubes, sector);
  return tubes;
}

/// A transmitter of two fans and a separate receiver of three beams per fan.
struct Apart {
  FacetMesh mesh = wavy_seabed();
  SceneTree tree{mesh};
  RayScene scene{mesh, grid};
  TubeSet sent = fan({-1.5, 0, 0}, 2, 1, 70, 40), received = fan({2, 0.5, 0.7}, 6, 2, 60, 40);
  std::vector<std::uint32_t> beam, fan_sent{0, 1}, fan_received;
  std::vector<double> mu{0.002};
  std::vector<std::shared_ptr<const ReflectivityField>> texture;
  std::vector<std::shared_ptr<const ScatteringModel>> model;
  BeamPatterns patterns;
  const BeamPatterns* weighed = nullptr;
  RangeSamples samples{3, 1.5, 8};

  Apart() {
    for (std::uint32_t tube = 0; tube < 12; ++tube) {
      beam.push_back(tube / 2);
      fan_received.push_back(tube / 6);
    }
  }
  void weigh() {
    patterns.transmit = {Directivity{Directivity::Kind::line, {1, 0, 0}, false, 0.1, 4},
                         Directivity{Directivity::Kind::line, {1, 0, 0}, false, -0.2, 3}};
    for (int b = 0; b < 6; ++b)
      patterns.receive.push_back({Directivity::Kind::line, {1, 0, 0}, false, 0.15 * (b - 2.5), 6});
    patterns.fan_of_tube = fan_received;
    for (std::uint32_t tube = 0; tube < 12; ++tube)
      patterns.beams_of_tube.emplace_back(3 * fan_received[tube], 3 * fan_received[tube] + 3);
    weighed = &patterns;
  }
  Echo echo(const BistaticHistory& history) const {
    EchoModel model_of{mu, mesh.material, 0.1, weighed};
    model_of.reflectivity = texture;
    model_of.scattering = model;
    model_of.path.tx.apex_m = grid.to_metres(sent.apex);
    return integrate_echo(history, {6, beam, fan_sent, fan_received}, samples, model_of);
  }
  Echo exact() const { return echo(trace_bistatic(mesh, tree, grid.unit_m(), {}, sent, received)); }
  BistaticHistory rays(const RaySettings& settings) const {
    const TubeFinder sent_tubes(sent), received_tubes(received);
    return shared_hits(trace_rays(scene, sent, grid.unit_m(), settings), {scene, sent, sent_tubes},
                       {scene, received, received_tubes}, mesh);
  }
};

/// Means over seeds agree within six standard errors, bin by bin. The standard errors are small enough for
/// a significant check.
void expect_mean(const Echo& exact, int seeds, double least_said,
                 const std::function<Echo(std::uint64_t)>& sampled) {
  std::vector<Statistics> bins(exact.energy.size());
  for (int seed = 1; seed <= seeds; ++seed) {
    const Echo echo = sampled(std::uint64_t(seed));
    for (std::size_t k = 0; k < bins.size(); ++k) bins[k].add(echo.energy[k]);
  }
  double wide = 0, squares = 0;
  int lit = 0;
  for (std::size_t k = 0; k < bins.size(); ++k) {
    const double sigma = bins[k].sigma_of_mean();
    EXPECT_NEAR(bins[k].mean(), exact.energy[k], 6 * sigma + 1e-4 * total(exact)) << k;
    wide += sigma;
    if (exact.energy[k] > 1e-3 * total(exact)) {
      squares += std::pow((bins[k].mean() - exact.energy[k]) / sigma, 2);
      ++lit;
    }
  }
  EXPECT_LT(wide, least_said * total(exact));
  ASSERT_GT(lit, 10);
  EXPECT_LT(squares / lit, 1 + 6 * std::sqrt(2.0 / lit));  // chi squared
}

TEST(SharedHits, TheMeanOverSeedsIsWhatTubesShare) {
  Apart apart;
  for (const RaySampling sampling : {RaySampling::stratified, RaySampling::random, RaySampling::adaptive}) {
    SCOPED_TRACE(name_of(sampling));
    expect_mean(apart.exact(), 30, 0.04, [&](std::uint64_t seed) {
      return apart.echo(apart.rays({sampling, 6000, RaySettings::Per::ping, seed}));
    });
  }
}

TEST(SharedHits, WithPatternsLawAndTexture) {
  Apart apart;
  apart.weigh();
  apart.texture = {std::make_shared<const PerlinReflectivity>(
      PerlinReflectivity::Settings{.wavelength_m = 2, .octaves = 1, .depth = 0.8, .seed = 4})};
  apart.model = {std::make_shared<const ScatteringModel>(ScatteringModel::lambert(0.01))};
  expect_mean(apart.exact(), 30, 0.05,
              [&](std::uint64_t seed) { return apart.echo(apart.rays(stratified(6000, seed))); });
}

TEST(SharedHits, ErrorsFallWithTheNumberOfRays) {
  const Apart apart;
  const Echo exact = apart.exact();
  const auto error = [&](RaySampling sampling, std::int64_t rays) {
    double squares = 0;
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
      const Echo echo = apart.echo(apart.rays({sampling, rays, RaySettings::Per::ping, seed}));
      double sum = 0;
      for (std::size_t k = 0; k < echo.energy.size(); ++k) sum += std::abs(echo.energy[k] - exact.energy[k]);
      squares += sum * sum;
    }
    return std::sqrt(squares / 12) / total(exact);
  };
  // Sixteen times the rays give a quarter of the error, or less where cells of directions are uniform.
  EXPECT_NEAR(error(RaySampling::random, 1000) / error(RaySampling::random, 16000), 4, 0.8);
  EXPECT_GT(error(RaySampling::stratified, 1000) / error(RaySampling::stratified, 16000), 5);
  EXPECT_LT(error(RaySampling::regular, 300000), 0.01);
}

TEST(SharedHits, InOnePlaceTheyAreTheHitsOfOneApex) {
  Apart apart;
  apart.received = apart.sent;
  apart.beam = {0, 1};
  apart.fan_received = apart.fan_sent;
  const RaySettings settings = stratified(20000, 3);
  const History history = trace_rays(apart.scene, apart.sent, grid.unit_m(), settings);
  const BistaticHistory both = apart.rays(settings);
  ASSERT_GT(history.hits.size(), 10000u);
  EXPECT_EQ(both.hits.size(), history.hits.size());
  for (const SharedHit& hit : both.hits) ASSERT_EQ(hit.transmit_tube, hit.receive_tube);
  EchoModel model{apart.mu, apart.mesh.material, 0.1};
  const RangeSamples one{0, 1000, 1};
  const Echo alone = integrate_echo(history, {2, apart.beam}, one, model),
             same = integrate_echo(both, {2, apart.beam}, one, model);
  for (int b = 0; b < 2; ++b) EXPECT_NEAR(same.at(b, 0), alone.at(b, 0), 1e-5 * alone.at(b, 0));
}

TEST(SharedHits, AWallHidesWhatEitherOfThemCannotSee) {
  // The scene is that of the test of BistaticEcho: shadows of 6 m on both sides.
  for (const double wall_m : {0.0, 3.0, 5.0}) {
    FacetMesh mesh;
    add_rectangle(mesh, {-16, 2, -4}, {32, 0, 0}, {0, 16, 0});
    if (wall_m > 0) add_rectangle(mesh, {0, -1, -4}, {0, 20, 0}, {0, 0, wall_m});
    const RayScene scene(mesh, grid);
    const TubeSet left = fan({-2, 0, 0}, 1, 1, 170, 80, 45), right = fan({2, 0, 0}, 1, 1, 170, 80, 45);
    const TubeFinder there(left), back(right);
    const BistaticHistory both = shared_hits(trace_rays(scene, left, grid.unit_m(), stratified(20000, 1)),
                                             {scene, left, there}, {scene, right, back}, mesh);
    EXPECT_EQ(both.hits.empty(), wall_m == 5);
    double nearest = 20;
    for (const SharedHit& hit : both.hits) nearest = std::min(nearest, std::abs(hit.at_m.x - 2));
    if (wall_m == 0) {
      EXPECT_LT(nearest, 0.1);
    } else if (wall_m == 3) {
      EXPECT_NEAR(nearest, 6, 0.1);
    }
  }
}

TEST(SharedHits, TubesOfTheReceiverShareOutTheHits) {
  Apart apart;
  apart.received = fan({2, 0.5, 0.7}, 6, 4, 60, 40);
  const BistaticHistory many = apart.rays(stratified(20000, 5));
  apart.received = fan({2, 0.5, 0.7}, 6, 1, 60, 40);  // walls across are planes through the same rays
  const BistaticHistory one = apart.rays(stratified(20000, 5));
  EXPECT_EQ(many.hits.size(), one.hits.size());
  ASSERT_GT(one.hits.size(), 3000u);
  for (std::size_t k = 0; k < one.hits.size(); ++k) ASSERT_EQ(one.hits[k].at_m, many.hits[k].at_m);
}

TEST(SharedHits, ThreadsChangeNoBit) {
  const Apart apart;
  const auto with = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return apart.echo(apart.rays(stratified(20000, 9))).energy;
  };
  EXPECT_EQ(with(1), with(4));
}

// Each end sees the seabed at other apparent positions. Rays transfer from the apparent facets of one end
// to those of the other.
TEST(SharedHits, InRefractingWaterTheMeanIsWhatTubesShare) {
  Apart apart;
  const WaterColumn water{SoundSpeedProfile({{0, 1500}, {60, 1500 - 60 * 8.0}}), {}};
  const ApparentMap transmit(water, grid.to_metres(apart.sent.apex), 10, {}, 1500),
      receive(water, grid.to_metres(apart.received.apex), 10, {}, 1500);
  std::vector<FacetId> all(apart.mesh.facets.size());
  std::iota(all.begin(), all.end(), 0u);
  const ApparentPair pair =
      map_apparent_pair(apart.mesh, all, grid, transmit, receive, 0.1, {.travel_path_error_m = 0.01});
  const Echo straight = apart.exact();
  apart.mesh = pair.mesh;
  const Echo exact =
      apart.echo(trace_bistatic(pair, grid, {}, apart.sent, apart.received, transmit, receive, 0.1));
  double refracted = 0;
  for (std::size_t k = 0; k < exact.energy.size(); ++k)
    refracted += std::abs(exact.energy[k] - straight.energy[k]);
  ASSERT_GT(refracted, 0.03 * total(exact));
  const RayScene there(pair.transmit.refined.mesh, grid), back(pair.receive.refined.mesh, grid);
  const TubeFinder sent_tubes(apart.sent), received_tubes(apart.received);
  ApparentFacets facets;
  facets.received.assign(pair.mesh.facets.size(), ApparentFacets::none);
  for (FacetId f = 0; f < pair.receive_origin.size(); ++f) facets.received[pair.receive_origin[f]] = f;
  expect_mean(exact, 30, 0.02, [&](std::uint64_t seed) {
    BistaticHistory both =
        shared_hits(trace_rays(there, apart.sent, grid.unit_m(), stratified(6000, seed)),
                    {there, apart.sent, sent_tubes, pair.transmit_origin},
                    {back, apart.received, received_tubes, pair.receive_origin}, pair.mesh, &facets);
    both.bistatic = bistatic_facets(both.shared, pair, grid, transmit, receive, 0.1);
    return apart.echo(both);
  });
}

}  // namespace
}  // namespace tubefoot
