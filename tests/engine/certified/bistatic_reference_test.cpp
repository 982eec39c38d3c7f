// SPDX-License-Identifier: GPL-3.0-or-later
// Tests certified references of a separate transmitter and receiver in stratified water. The comparisons
// are closed forms of one gradient, the monostatic reference, straight references, reciprocity, and single
// rays for each facet enclosure.
#include "engine/certified/bistatic_reference.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "fixtures/world/gradient_pairs.hpp"
#include "fixtures/world/textures.hpp"

namespace tubefoot {
namespace {

using namespace test;

/// Transmitter and receiver over a flat seabed with optional objects.
struct Bistatic {
  const GradientSeabed& site;
  const WaterColumn& water;
  TubeSet sent, received;
  double absorption = 0;
  const BeamPatterns* patterns = nullptr;

  EigenrayOptions options{.deepest_turn_m = GradientSeabed::apex_depth_m + GradientSeabed::below_m};
  ApparentMap end(const TubeSet& tubes) const {
    return ApparentMap(water, site.grid.to_metres(tubes.apex), GradientSeabed::apex_depth_m, options, 1500);
  }
  RefractedReference certified(const ApparentMapSettings& settings, const RangeSamples& samples,
                               double tolerance) const {
    std::vector<FacetId> all(site.base.facets.size());
    std::iota(all.begin(), all.end(), 0u);
    const ApparentMap tx = end(sent), rx = end(received);
    const ViewBounds from_tx(sent, site.grid.unit_m(), tx), from_rx(received, site.grid.unit_m(), rx);
    const CommonApparentSurfaces alike =
        map_apparent_together(site.base, all, site.grid, std::array{&tx, &rx}, absorption, settings, {},
                              std::array{&from_tx, &from_rx});
    const ApparentPair pair{alike.seabed.mesh, alike.seen[0], alike.seen[1], alike.origin[0],
                            alike.origin[1]};
    EchoModel model = site.model(pair.mesh, absorption);
    model.patterns = patterns;
    const std::vector<std::uint32_t> beams(received.tubes.size(), 0);
    const Echo ordinary = integrate_echo(
        trace_bistatic(pair, site.grid, {}, sent, received, tx, rx, absorption), {1, beams}, samples, model);
    const RayEnclosure tx_rays(tx, options), rx_rays(rx, options);
    const SceneTree tx_tree(alike.seen[0].refined.mesh, SceneTree::HeightFieldSearch::ignored),
        rx_tree(alike.seen[1].refined.mesh, SceneTree::HeightFieldSearch::ignored);
    const BistaticSurface seabed{alike.seabed.mesh,
                                 alike.seabed.parent,
                                 site.base,
                                 site.grid,
                                 {alike.seen[0], tx_tree, alike.origin[0], tx, tx_rays},
                                 {alike.seen[1], rx_tree, alike.origin[1], rx, rx_rays}};
    return certify_refracted_echo(seabed, {sent, received}, {}, {1, beams}, samples, model, ordinary,
                                  tolerance);
  }
  CertifiedEcho straight(const RangeSamples& samples, double tolerance) const {
    EchoModel model = site.model(site.base, absorption);
    model.patterns = patterns;
    const std::vector<std::uint32_t> beams(received.tubes.size(), 0);
    const SceneTree tree(site.base);
    const BistaticHistory history = trace_bistatic(site.base, tree, site.grid.unit_m(), {}, sent, received);
    const Echo ordinary = integrate_echo(history, {1, beams}, samples, model);
    return certify_echo(site.base, history, {1, beams}, samples, model, ordinary, tolerance);
  }
};

// Bounds shrink with the travel-path error and are not far too wide. They fail when energies move by twice
// the bound.
TEST(BistaticReference, HoldsTheClosedFormOfOneGradient) {
  const GradientSeabed seabed = plate(from, to);
  const RangeSamples samples{22, 0.8, 16};
  for (const bool weighed : {false, true})
    for (const double g : {-0.6, 0.3}) {
      if (weighed && g > 0) continue;
      const double absorption = g < 0 ? 0.1 : 0;
      const WaterColumn water = seabed_gradient(g, absorption);
      Bistatic pair{seabed, water, at(seabed_fan(70), seabed.grid, transmitter),
                    at(seabed_fan(70), seabed.grid, receiver), absorption};
      const BeamPatterns patterns = patterns_for(pair.received);
      if (weighed) pair.patterns = &patterns;
      const std::vector<double> truth =
          rectangle({g, transmitter, receiver, absorption, pair.patterns}, from, to, samples);
      double before = 2, closest = 0;
      for (const double gap : {2e-2, 2e-3}) {
        SCOPED_TRACE(fmt::format("g {} gap {} weighed {}", g, gap, weighed));
        const RefractedReference found = pair.certified({.travel_path_error_m = gap}, samples, 1e-2);
        EXPECT_EQ(found.unbounded, 0u);
        double bounds = 0, energies = 0;
        for (std::size_t k = 0; k < truth.size(); ++k) {
          const double energy = found.certified.echo.energy[k], bound = found.certified.bound[k];
          EXPECT_LE(std::abs(energy - truth[k]), bound + 1e-6 * truth[k]) << k;
          if (!(truth[k] > 0)) continue;
          EXPECT_GT(std::abs(energy + 2 * bound - truth[k]), bound - 1e-6 * truth[k]) << k;
          closest = std::max(closest, std::abs(energy - truth[k]) / bound);
          bounds += bound;
          energies += energy;
        }
        EXPECT_GT(energies, 0);
        EXPECT_LT(bounds / energies, before / 3);
        before = bounds / energies;
      }
      EXPECT_LT(before, weighed ? 0.08 : 0.04);
      EXPECT_GT(closest, 0.02);
    }
}

void expect_agree(const CertifiedEcho& a, const CertifiedEcho& b, double scale = 1) {
  double lit = 0;
  for (std::size_t k = 0; k < a.bound.size(); ++k) {
    EXPECT_LE(std::abs(a.echo.energy[k] - scale * b.echo.energy[k]),
              a.bound[k] + scale * b.bound[k] + 1e-9 * a.echo.energy[k])
        << k;
    lit += a.echo.energy[k] > a.bound[k];
  }
  EXPECT_GT(lit, double(a.bound.size()) / 3);
}

TEST(BistaticReference, IsovelocityWaterIsTheStraightReference) {
  const WaterColumn even{SoundSpeedProfile({{0, 1500}, {50, 1500}}), {}};
  const RangeSamples samples{24, 2, 3};
  for (int kind = 0; kind < 4; ++kind) {
    SCOPED_TRACE(kind);
    GradientSeabed seabed(board(), 24, 8);
    if (kind == 1) seabed.models = {lobed(), nullptr};
    if (kind == 2) seabed.textures = {perlin(6, 1, 0.5), nullptr};
    Bistatic pair{seabed, even, at(seabed_fan(40), seabed.grid, transmitter),
                  at(seabed_fan(40), seabed.grid, receiver)};
    const BeamPatterns patterns = patterns_for(pair.received);
    if (kind == 3) pair.patterns = &patterns;
    const RefractedReference found = pair.certified({.travel_path_error_m = 1}, samples, 1e-4);
    EXPECT_EQ(found.unbounded, 0u);
    expect_agree(found.certified, pair.straight(samples, 1e-7));
    double bounds = 0, energies = 0;
    for (std::size_t k = 0; k < found.certified.bound.size(); ++k)
      bounds += found.certified.bound[k], energies += found.certified.echo.energy[k];
    EXPECT_LT(bounds, 3e-3 * energies);
  }
}

TEST(BistaticReference, InOnePlaceItIsTheReferenceOfOneApex) {
  const RangeSamples samples{24, 1.5, 8};
  for (int kind = 0; kind < 3; ++kind) {
    SCOPED_TRACE(kind);
    GradientSeabed seabed(board(), 32, 8);
    if (kind == 1) seabed.models = {lobed(), nullptr};
    if (kind == 2) seabed.textures = {perlin(6, 1, 0.5), nullptr};
    const WaterColumn water = seabed_gradient(-0.4, 0.05);
    const TubeSet tubes = seabed_fan(40);
    const Bistatic pair{seabed, water, tubes, tubes, 0.05};
    expect_agree(
        pair.certified({.travel_path_error_m = 2e-3}, samples, 1e-2).certified,
        seabed.certified(water, tubes, {.travel_path_error_m = 2e-3}, samples, 0.05, 1e-2).certified);
  }
}

// An exchange of the ends scales the energies by the squared ratio of the sound speeds at the ends
// (docs/notes/bistatic.md). Bounds of coarse apparent maps contain the energies of fine maps, also behind the
// board.
TEST(BistaticReference, ExchangeAndCoarserSurfacesAgree) {
  const RangeSamples samples{24, 1.5, 8};
  const double g = -0.4;
  GradientSeabed seabed(board(), 32, 8);
  seabed.models = {lobed(), nullptr};
  const WaterColumn water = seabed_gradient(g);
  const TubeSet a = at(seabed_fan(40), seabed.grid, transmitter),
                b = at(seabed_fan(40), seabed.grid, receiver);
  const CertifiedEcho
      there = Bistatic{seabed, water, a, b}.certified({.travel_path_error_m = 2e-3}, samples, 1e-2).certified,
      back = Bistatic{seabed, water, b, a}.certified({.travel_path_error_m = 2e-3}, samples, 1e-2).certified;
  expect_agree(back, there, std::pow((1500 - g * receiver.z) / 1500, 2));
  const CertifiedEcho coarse =
      Bistatic{seabed, water, a, b}.certified({.travel_path_error_m = 2e-2}, samples, 1e-2).certified;
  for (std::size_t k = 0; k < coarse.bound.size(); ++k)
    EXPECT_LE(std::abs(coarse.echo.energy[k] - there.echo.energy[k]), coarse.bound[k] + there.bound[k]) << k;
}

// Compares each enclosure of a facet with single eigenrays to points on the facet, in one layer and in
// several.
TEST(BistaticReference, EnclosuresHoldWhatRaysToPlacesSay) {
  constexpr std::uint64_t seed = 5;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  double closest_factor = 0, closest_shift = 0, closest_turn = 0;
  std::size_t proven = 0;
  const auto model = lobed();
  for (int trial = 0; trial < 60; ++trial) {
    SCOPED_TRACE(fmt::format("seed {} trial {}", seed, trial));
    const glm::dvec3 place(4 + 30 * unit(random), 10 * unit(random) - 5, -6 - 12 * unit(random)),
        rx_m(6 * unit(random) - 3, 6 * unit(random) - 3, 4 * unit(random) - 2);
    const double size = trial % 3 ? 2 : 0.4, absorption = 0.1;
    Triangle t;
    for (glm::dvec3& p : t)
      p = place + size * glm::dvec3(unit(random) - 0.5, unit(random) - 0.5, unit(random) - 0.5);
    GradientSeabed site({t});
    if (trial % 2) site.models = {nullptr, model};
    const WaterColumn one = seabed_gradient(trial % 4 < 2 ? 0.7 : -0.7, absorption);
    const WaterColumn layers{SoundSpeedProfile({{0, 1530}, {11, 1515}, {13, 1495}, {30, 1490}}),
                             {0.1, 0.12, 0.09, 0.08, 0.1}};
    const WaterColumn& water = trial % 8 < 4 ? one : layers;
    const EigenrayOptions options{.deepest_turn_m = 30};
    const glm::dvec3 apexes[2]{glm::dvec3(0), site.grid.to_metres(site.grid.snap(rx_m))};
    const ApparentMap tx(water, apexes[0], GradientSeabed::apex_depth_m, options, 1500),
        rx(water, apexes[1], GradientSeabed::apex_depth_m, options, 1500);
    const std::vector<FacetId> facets{FacetId(site.base.facets.size() - 1)};
    const CommonApparentSurfaces alike =
        map_apparent_together(site.base, facets, site.grid, std::array{&tx, &rx}, absorption,
                              {.travel_path_error_m = 1e9}, {}, std::array<const ViewBounds*, 2>{});
    const FacetMesh& mesh = alike.seabed.mesh;
    if (alike.origin[0].size() != 1 || alike.origin[1].size() != 1) continue;
    SharedFootprints shared;
    shared.receiver_m = apexes[1];
    const auto corner = [&](int e, int k) {
      return site.grid.to_metres(alike.seen[std::size_t(e)].refined.mesh.vertices[mesh.facets[0][k]]) -
             apexes[e];
    };
    glm::dvec3 normal = glm::normalize(glm::cross(corner(0, 1) - corner(0, 0), corner(0, 2) - corner(0, 0)));
    const glm::dvec3 other = glm::cross(corner(1, 1) - corner(1, 0), corner(1, 2) - corner(1, 0));
    // the transmitter sees the other side
    if (glm::dot(normal, corner(0, 0)) * glm::dot(other, corner(1, 0)) < 0) continue;
    if (glm::dot(normal, corner(0, 0)) > 0) normal = -normal;
    shared.facets.push_back({0, 0, 0, normal, 1, 1});
    const auto bistatic =
        bistatic_facets(shared, mesh, {alike.seen[0], tx}, {alike.seen[1], rx}, site.grid, absorption);
    const RayEnclosure tx_rays(tx, options), rx_rays(rx, options);
    const SceneTree tx_tree(alike.seen[0].refined.mesh), rx_tree(alike.seen[1].refined.mesh);
    const EchoModel echo_model = site.model(mesh, absorption);
    const BistaticEnclosures all = enclose({mesh,
                                            alike.seabed.parent,
                                            site.base,
                                            site.grid,
                                            {alike.seen[0], tx_tree, alike.origin[0], tx, tx_rays},
                                            {alike.seen[1], rx_tree, alike.origin[1], rx, rx_rays}},
                                           shared.facets, bistatic, echo_model);
    const BistaticEnclosure& facet = all.facets[0];
    if (!facet.proven) continue;
    ++proven;
    const BistaticFacet& flattened = bistatic[0];
    Triangle lies;
    for (int k = 0; k < 3; ++k) lies[std::size_t(k)] = site.grid.to_metres(mesh.vertices[mesh.facets[0][k]]);
    const glm::dvec3 across = glm::cross(lies[1] - lies[0], lies[2] - lies[0]), up = glm::normalize(across);
    const double flattened_area =
        glm::length(glm::cross(flattened.to_plane.linear * (corner(0, 1) - corner(0, 0)),
                               flattened.to_plane.linear * (corner(0, 2) - corner(0, 0))));
    for (int k = 0; k < 60; ++k) {
      double a = unit(random), b = unit(random);
      if (a + b > 1) a = 1 - a, b = 1 - b;
      const auto between = [&](const glm::dvec3& p, const glm::dvec3& q, const glm::dvec3& r) {
        return p + a * (q - p) + b * (r - p);
      };
      const glm::dvec3 there = between(lies[0], lies[1], lies[2]);
      const glm::dvec2 flat(flattened.to_plane.at(between(corner(0, 0), corner(0, 1), corner(0, 2))));
      const double range[2]{
          std::hypot(glm::length(flat), flattened.transmit_distance_m),
          std::hypot(glm::length(flat - flattened.receive_foot_m), flattened.receive_distance_m)};
      const double height[2]{flattened.transmit_distance_m, flattened.receive_distance_m};
      const double beta = std::numbers::ln10 / 10;
      double half = 0, truth = glm::length(across), modelled = flattened_area;
      for (const int e : {0, 1}) {
        const ApparentMap& water_from = e == 0 ? tx : rx;
        const auto image = water_from.apparent(there);
        ASSERT_TRUE(image);
        const double ray_m = 1500 * image->ray.time_s;
        half += (ray_m - range[e]) / 2;
        const double sine = std::abs(glm::dot(up, water_from.arrival_direction(there, image->ray)));
        const auto sigma = [](const ScatteringModel& of, double s) {
          return std::sqrt(of.cross_section(s, std::sqrt((1 - s) * (1 + s))));
        };
        truth *=
            (trial % 2 ? sigma(*model, sine) : sine) * std::exp(-beta * image->ray.absorption_db) /
            (e == 0 ? image->ray.tube_area_m2_per_sr : water_from.return_area_m2_per_sr(there, image->ray));
        const double seen_sine = height[e] / range[e];
        modelled *= (trial % 2 ? sigma(*facet.model[std::size_t(e)], seen_sine) : seen_sine) *
                    std::exp(-beta * absorption * range[e]) / (range[e] * range[e]);
        const LyingPlane& seen = e == 0 ? flattened.transmit_seen : flattened.receive_seen;
        const double turn = glm::distance(glm::normalize(image->at_m - apexes[e]), seen.towards(flat));
        EXPECT_LE(turn, facet.turn_rad[std::size_t(e)] * (1 + 1e-9) + 1e-12);
        EXPECT_LE(std::abs(glm::length(seen.at(flat)) / range[e] - 1), facet.stretch[std::size_t(e)] + 1e-12);
        closest_turn = std::max(closest_turn, turn / facet.turn_rad[std::size_t(e)]);
      }
      EXPECT_LE(std::abs(half), facet.shift_m);
      closest_shift = std::max(closest_shift, std::abs(half) / facet.shift_m);
      EXPECT_GE(truth / modelled, facet.factor.lo * (1 - 1e-9));
      EXPECT_LE(truth / modelled, facet.factor.hi * (1 + 1e-9));
      closest_factor = std::max(
          closest_factor, std::abs(truth / modelled - facet.factor.middle()) / (facet.factor.width() / 2));
      EXPECT_LE(truth, all.ends[0].facets[0].most / (trial % 2 ? 1 : site.material_mu()[1]) * 2 *
                           (1 + 1e-9));  // twice the area
    }
  }
  EXPECT_GT(proven, 25u);
  EXPECT_GT(closest_factor, 0.3);
  EXPECT_GT(closest_shift, 0.05);
  EXPECT_GT(closest_turn, 0.1);
}

}  // namespace
}  // namespace tubefoot
