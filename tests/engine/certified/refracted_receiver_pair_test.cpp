// SPDX-License-Identifier: GPL-3.0-or-later
// Tests certified references of a receiver pair in stratified water. The comparisons are closed forms of
// one gradient, straight references, references of one receiver, and laws that hold in any water.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <glm/geometric.hpp>
#include <numeric>

#include "engine/certified/bistatic_reference.hpp"
#include "engine/certified/receiver_pair_reference.hpp"
#include "fixtures/world/gradient_pairs.hpp"
#include "fixtures/world/textures.hpp"

namespace tubefoot {
namespace {

using namespace test;

/// A transmitter and a receiver pair over a flat seabed with optional objects.
struct Staffed {
  const GradientSeabed& site;
  const WaterColumn& water;
  glm::dvec3 sent_m{0}, middle_m{0};
  ReceiverBaseline receiver_pair{};
  RangeSamples samples{22, 0.8, 16};
  double absorption = 0;
  BeamPatterns patterns{{TransmitPattern()}, {Directivity()}, {}, {}};
  double width_deg = 70;

  EigenrayOptions options{.deepest_turn_m = GradientSeabed::apex_depth_m + GradientSeabed::below_m};
  TubeSet tubes_from(glm::dvec3 apex_m) const { return at(seabed_fan(width_deg), site.grid, apex_m); }
  glm::dvec3 end_m(double end) const {
    return middle_m + end * receiver_pair.baseline_m / 2 * receiver_pair.axis;
  }
  ApparentMap seen_from(glm::dvec3 apex_m) const {
    return ApparentMap(water, apex_m, GradientSeabed::apex_depth_m, options, 1500);
  }
  BeamPatterns for_tubes(const TubeSet& tubes) const {
    BeamPatterns own = patterns;
    own.fan_of_tube.assign(tubes.tubes.size(), 0);
    own.beams_of_tube.assign(tubes.tubes.size(), {0, 1});
    return own;
  }

  RefractedReference certified(const ApparentMapSettings& settings, double tolerance) const {
    std::vector<FacetId> all(site.base.facets.size());
    std::iota(all.begin(), all.end(), 0u);
    const double unit = site.grid.unit_m();
    const TubeSet sent = tubes_from(sent_m), middle = tubes_from(middle_m);
    const std::array<TubeSet, 2> received{moved_along(middle, receiver_pair, 1, unit),
                                          moved_along(middle, receiver_pair, -1, unit)};
    const ApparentMap tx = seen_from(site.grid.to_metres(sent.apex)), upper = seen_from(end_m(1)),
                      lower = seen_from(end_m(-1));
    const ViewBounds from_tx(sent, unit, tx), from_upper(received[0], unit, upper),
        from_lower(received[1], unit, lower);
    const CommonApparentSurfaces alike =
        map_apparent_together(site.base, all, site.grid, std::array{&tx, &upper, &lower}, absorption,
                              settings, {}, std::array{&from_tx, &from_upper, &from_lower});
    EchoModel model = site.model(alike.seabed.mesh, absorption);
    const BeamPatterns own = for_tubes(sent);
    model.patterns = &own;
    const RayEnclosure tx_rays(tx, options), upper_rays(upper, options), lower_rays(lower, options);
    std::vector<SceneTree> trees;
    for (const ApparentSurface& surface_mesh : alike.seen)
      trees.emplace_back(surface_mesh.refined.mesh, SceneTree::HeightFieldSearch::ignored);
    const std::array<ApparentMap const*, 2> waters{&upper, &lower};
    const std::array<RayEnclosure const*, 2> rays{&upper_rays, &lower_rays};
    std::array<Echo, 2> ordinary;
    const std::vector<std::uint32_t> beams(sent.tubes.size(), 0);
    for (std::size_t e = 0; e < 2; ++e) {
      const ApparentPair pair{alike.seabed.mesh, alike.seen[0], alike.seen[1 + e], alike.origin[0],
                              alike.origin[1 + e]};
      ordinary[e] =
          integrate_echo(trace_bistatic(pair, site.grid, {}, sent, received[e], tx, *waters[e], absorption),
                         {1, beams}, samples, model);
    }
    const auto seabed = [&](std::size_t e) {
      return BistaticSurface{alike.seabed.mesh,
                             alike.seabed.parent,
                             site.base,
                             site.grid,
                             {alike.seen[0], trees[0], alike.origin[0], tx, tx_rays},
                             {alike.seen[1 + e], trees[1 + e], alike.origin[1 + e], *waters[e], *rays[e]}};
    };
    return certify_refracted_receiver_pair({seabed(0), seabed(1)},
                                           {BistaticTubes{sent, received[0]}, {sent, received[1]}}, {},
                                           receiver_pair, samples, model, ordinary, tolerance);
  }

  /// Computes without bounds: the receivers use the apparent positions as seen from the middle of the pair.
  ReceiverPairEcho ordinary(const ApparentMapSettings& settings) const {
    std::vector<FacetId> all(site.base.facets.size());
    std::iota(all.begin(), all.end(), 0u);
    const TubeSet sent = tubes_from(sent_m), middle = tubes_from(middle_m);
    const ApparentMap tx = seen_from(sent_m), rx = seen_from(middle_m);
    const ApparentPair pair = map_apparent_pair(site.base, all, site.grid, tx, rx, absorption, settings);
    ReceiverBaseline stretched = receiver_pair;
    stretched.baseline_m *=
        1500 / water.profile.at(GradientSeabed::apex_depth_m - site.grid.to_metres(middle.apex).z);
    const ReceiverPairHistory history =
        trace_receiver_pair(pair, site.grid, {}, sent, middle, stretched, tx, rx, absorption);
    EchoModel model = site.model(pair.mesh, absorption);
    const BeamPatterns own = for_tubes(sent);
    model.patterns = &own;
    return integrate_receiver_pair_echo(history, stretched, 0, 0, samples, model);
  }

  CertifiedEcho straight(double tolerance) const {
    EchoModel model = site.model(site.base, absorption);
    const SceneTree tree(site.base);
    const TubeSet sent = tubes_from(sent_m);
    const BeamPatterns own = for_tubes(sent);
    model.patterns = &own;
    const ReceiverPairHistory history = trace_receiver_pair(site.base, tree, site.grid.unit_m(), {}, sent,
                                                            tubes_from(middle_m), receiver_pair);
    const ReceiverPairEcho echo = integrate_receiver_pair_echo(history, receiver_pair, 0, 0, samples, model);
    return certify_receiver_pair_echo(site.base, history, site.grid.unit_m(), receiver_pair, samples, model,
                                      echo, tolerance);
  }

  GradientPath by(double g, double end) const { return {g, sent_m, end_m(end), absorption, &patterns}; }
};

/// Returns the rows of a rectangle of the seabed in the order of certify_receiver_pair_echo().
std::vector<double> rectangle_rows(const Staffed& scene, double g, glm::dvec2 from, glm::dvec2 to) {
  const RangeSamples& samples = scene.samples;
  const GradientPath upper = scene.by(g, 1), lower = scene.by(g, -1);
  std::vector<double> rows = rectangle(upper, from, to, samples), down = rectangle(lower, from, to, samples);
  const auto row = rows.size();
  rows.insert(rows.end(), down.begin(), down.end());
  rows.resize(4 * row, 0);
  using Rule = boost::math::quadrature::gauss<double, 20>;
  each_cell(std::array{upper, lower}, from, to, samples,
            [&](std::size_t sample, double dy, double y, double first, double last) {
              const auto product = [&](double x) {
                const glm::dvec3 place = GradientPath::place(x, y);
                const double phase =
                    scene.receiver_pair.wavenumber_rad_m * 1500 *
                    (RefractedPath(g, upper.rx, place).time_s - RefractedPath(g, lower.rx, place).time_s);
                return std::polar(std::sqrt(upper.density(x, y) * lower.density(x, y)), phase);
              };
              rows[2 * row + sample] +=
                  dy * Rule::integrate([&](double x) { return product(x).real(); }, first, last);
              rows[3 * row + sample] +=
                  dy * Rule::integrate([&](double x) { return product(x).imag(); }, first, last);
            });
  return rows;
}

ReceiverBaseline receiver_pair_of(double baseline_m, double wavelength_m) {
  return {glm::normalize(glm::dvec3(0.4, 0.1, 0.9)), baseline_m, 2 * std::numbers::pi / wavelength_m};
}

/// Returns the energy that scales a value: the energy itself, or for a product the geometric mean of both
/// energies.
double size_at(const std::vector<double>& rows, std::size_t bin) {
  const std::size_t row = rows.size() / 4, k = bin % row;
  return bin < 2 * row ? rows[bin] : std::sqrt(std::max(rows[k] * rows[row + k], 0.0));
}

double share(const RefractedReference& found) {
  const auto& c = found.certified;
  double bounds = 0, sizes = 0;
  for (std::size_t k = 0; k < c.bound.size(); ++k) bounds += c.bound[k], sizes += size_at(c.echo.energy, k);
  return bounds / sizes;
}

// Compares energies and products with receivers whose rays are arcs, including travel times. The
// transmitter lies in the middle of the pair or elsewhere. Bounds shrink with the travel-path error, and
// fail when a value moves by twice the bound.
TEST(RefractedReceiverPair, HoldsTheClosedFormOfOneGradient) {
  const GradientSeabed seabed = plate(from, to);
  for (const bool apart : {false, true})
    for (const double g : {-0.6, 0.3}) {
      if (apart != (g < 0)) continue;
      const bool weighed = apart;
      const double absorption = g < 0 ? 0.1 : 0;
      const WaterColumn water = seabed_gradient(g, absorption);
      Staffed scene{.site = seabed,
                    .water = water,
                    .middle_m = apart ? receiver : transmitter,
                    .receiver_pair = receiver_pair_of(0.12, 0.03),
                    .absorption = absorption};
      if (weighed) {
        scene.patterns.transmit = patterns_for({}).transmit;
        scene.patterns.receive = {Directivity{
            .kind = Directivity::Kind::gaussian, .axis = {0.8, 0, -0.6}, .from_axis = true, .size = 0.7}};
      }
      const std::vector<double> truth = rectangle_rows(scene, g, from, to);
      double before = 2, closest[2]{};
      for (const double gap : {2e-2, 2e-3}) {
        SCOPED_TRACE(fmt::format("apart {} g {} gap {}", apart, g, gap));
        const RefractedReference found = scene.certified({.travel_path_error_m = gap}, 1e-2);
        EXPECT_EQ(found.unbounded, 0u);
        double turned = 0;
        for (std::size_t k = 0; k < truth.size(); ++k) {
          const double value = found.certified.echo.energy[k], bound = found.certified.bound[k],
                       rounding = 1e-6 * size_at(truth, k);
          EXPECT_LE(std::abs(value - truth[k]), bound + rounding) << k;
          if (!(size_at(truth, k) > 0)) continue;
          EXPECT_GT(std::abs(value + 2 * bound - truth[k]), bound - rounding) << k;
          double& own = closest[k >= truth.size() / 2];
          own = std::max(own, std::abs(value - truth[k]) / bound);
          if (k >= 3 * truth.size() / 4) turned = std::max(turned, std::abs(truth[k]) / size_at(truth, k));
        }
        EXPECT_GT(turned, 0.3);
        const double now = share(found);
        EXPECT_LT(now, before / 3);
        before = now;
      }
      EXPECT_LT(before, 0.05);
      EXPECT_GT(closest[0], 0.02);
      EXPECT_GT(closest[1], 0.01);
    }
}

void expect_agree(const CertifiedEcho& a, std::size_t a_row, const CertifiedEcho& b, std::size_t b_row,
                  double sign = 1) {
  const auto row = std::size_t(a.echo.samples);
  for (std::size_t k = 0; k < row; ++k) {
    const double one = a.echo.energy[a_row * row + k], other = sign * b.echo.energy[b_row * row + k];
    EXPECT_LE(std::abs(one - other),
              a.bound[a_row * row + k] + b.bound[b_row * row + k] + 1e-9 * std::abs(one))
        << a_row << ' ' << b_row << ' ' << k;
  }
}
void expect_agree(const CertifiedEcho& a, const CertifiedEcho& b) {
  for (std::size_t row = 0; row < 4; ++row) expect_agree(a, row, b, row);
}

// The cases include scattering models, textures, patterns, and a board that hides parts of the seabed from
// each end.
TEST(RefractedReceiverPair, IsovelocityWaterIsTheStraightReference) {
  const WaterColumn even{SoundSpeedProfile({{0, 1500}, {50, 1500}}), {}};
  for (int kind = 0; kind < 4; ++kind)
    for (const glm::dvec3 middle : {transmitter, receiver}) {
      if (kind % 2 == 1 && middle == transmitter) continue;
      SCOPED_TRACE(fmt::format("kind {} at {}", kind, middle.z));
      GradientSeabed seabed(board(), 24, 8);
      if (kind == 1) seabed.models = {lobed(), nullptr};
      if (kind == 2) seabed.textures = {perlin(6, 1, 0.5), nullptr};
      Staffed scene{.site = seabed,
                    .water = even,
                    .middle_m = middle,
                    .receiver_pair = receiver_pair_of(0.1, 0.03),
                    .samples = {24, 2, 3},
                    .width_deg = 40};
      if (kind == 3)
        scene.patterns.receive = {Directivity{
            .kind = Directivity::Kind::gaussian, .axis = {0.8, 0, -0.6}, .from_axis = true, .size = 0.7}};
      const RefractedReference found = scene.certified({.travel_path_error_m = 1}, 1e-4);
      EXPECT_EQ(found.unbounded, 0u);
      expect_agree(found.certified, scene.straight(1e-4));
      EXPECT_LT(share(found), 6e-3);
    }
}

// The effect of a gradient vanishes with the gradient, in first order.
TEST(RefractedReceiverPair, AGradientThatGoesToZeroLeavesIsovelocityWater) {
  const GradientSeabed seabed = plate(from, to);
  const WaterColumn even{SoundSpeedProfile({{-10, 1500}, {60, 1500}}), {}};
  Staffed scene{.site = seabed, .water = even, .receiver_pair = receiver_pair_of(0.12, 0.03)};
  const CertifiedEcho straight = scene.straight(1e-5);
  double changed[2];
  for (int k = 0; k < 2; ++k) {
    const WaterColumn water = seabed_gradient(k == 0 ? 0.6 : 0.3);
    Staffed refracted{.site = seabed, .water = water, .receiver_pair = scene.receiver_pair};
    const CertifiedEcho found = refracted.certified({.travel_path_error_m = 1e-3}, 1e-2).certified;
    changed[k] = 0;
    double bounds = 0;
    for (std::size_t bin = 0; bin < found.bound.size(); ++bin) {
      changed[k] += std::abs(found.echo.energy[bin] - straight.echo.energy[bin]);
      bounds += found.bound[bin] + straight.bound[bin];
    }
    EXPECT_LT(bounds, 0.4 * changed[k]);
  }
  EXPECT_NEAR(changed[0] / changed[1], 2, 0.2);
  const WaterColumn hardly = seabed_gradient(1e-6);
  expect_agree(Staffed{.site = seabed, .water = hardly, .receiver_pair = scene.receiver_pair}
                   .certified({.travel_path_error_m = 1e-2}, 1e-2)
                   .certified,
               straight);
}

TEST(RefractedReceiverPair, SwappedReceiversAreConjugateAndNoBaselineIsOneReceiver) {
  const WaterColumn water = seabed_gradient(-0.4);
  GradientSeabed seabed(board(), 24, 8);
  for (const glm::dvec3 middle : {transmitter, receiver}) {
    Staffed scene{.site = seabed,
                  .water = water,
                  .middle_m = middle,
                  .receiver_pair = receiver_pair_of(0.1, 0.03),
                  .samples = {24, 2, 4},
                  .width_deg = 40};
    const CertifiedEcho there = scene.certified({.travel_path_error_m = 5e-3}, 1e-2).certified;
    scene.receiver_pair.axis = -scene.receiver_pair.axis;
    const CertifiedEcho back = scene.certified({.travel_path_error_m = 5e-3}, 1e-2).certified;
    expect_agree(there, 0, back, 1);
    expect_agree(there, 1, back, 0);
    expect_agree(there, 2, back, 2);
    expect_agree(there, 3, back, 3, -1);
    scene.receiver_pair.baseline_m = 0;
    const CertifiedEcho one = scene.certified({.travel_path_error_m = 5e-3}, 1e-2).certified;
    expect_agree(one, 0, one, 1);
    expect_agree(one, 2, one, 0);
    expect_agree(one, 3, one, 3, -1);
    double turned = 0;
    for (std::size_t k = 0; k < 4; ++k)
      turned = std::max(turned, std::abs(there.echo.energy[12 + k]) / (5 * there.bound[12 + k]));
    EXPECT_GT(turned, 1);
  }
}

// The energies of two parts of a seabed add up. The product of both receivers is at most the energy of
// either receiver.
TEST(RefractedReceiverPair, PartsOfTheSeabedAddUp) {
  const glm::dvec2 lower_end(17, from.y), upper_end(17, to.y);
  const GradientSeabed whole = plate(from, to), near = plate(from, upper_end), far = plate(lower_end, to);
  const WaterColumn water = seabed_gradient(-0.5);
  const auto of = [&](const GradientSeabed& seabed) {
    return Staffed{
        .site = seabed, .water = water, .middle_m = receiver, .receiver_pair = receiver_pair_of(0.12, 0.03)}
        .certified({.travel_path_error_m = 4e-3}, 1e-2)
        .certified;
  };
  const CertifiedEcho all = of(whole);
  CertifiedEcho sum = of(near);
  const CertifiedEcho rest = of(far);
  for (std::size_t bin = 0; bin < sum.bound.size(); ++bin) {
    sum.echo.energy[bin] += rest.echo.energy[bin];
    sum.bound[bin] += rest.bound[bin];
  }
  expect_agree(all, sum);
  const std::size_t row = all.bound.size() / 4;
  for (std::size_t k = 0; k < row; ++k)
    EXPECT_LE(std::hypot(all.echo.energy[2 * row + k], all.echo.energy[3 * row + k]),
              size_at(all.echo.energy, 2 * row + k) + all.bound[k] + all.bound[row + k] +
                  all.bound[2 * row + k] + all.bound[3 * row + k]);
}

// The computation without bounds uses the apparent seabed as seen from the middle of the receiver pair.
TEST(RefractedReceiverPair, OrdinaryEnergiesAndProductsLieWithin) {
  GradientSeabed seabed(board(), 24, 8);
  const WaterColumn water = seabed_gradient(-0.4);
  for (const glm::dvec3 middle : {transmitter, receiver}) {
    SCOPED_TRACE(middle.z);
    Staffed scene{.site = seabed,
                  .water = water,
                  .middle_m = middle,
                  .receiver_pair = receiver_pair_of(0.1, 0.03),
                  .samples = {24, 2, 4},
                  .width_deg = 40};
    const std::vector<double> ordinary =
        rows_of(scene.ordinary({.travel_path_error_m = 2e-3, .tolerance_db = 0.002})).energy;
    const RefractedReference found =
        scene.certified({.travel_path_error_m = 2e-3, .tolerance_db = 0.05}, 1e-2);
    EXPECT_EQ(found.unbounded, 0u);
    for (std::size_t bin = 0; bin < ordinary.size(); ++bin) {
      const double value = found.certified.echo.energy[bin], bound = found.certified.bound[bin],
                   off = 2e-3 * size_at(ordinary, bin);
      EXPECT_LE(std::abs(value - ordinary[bin]), bound + off) << bin;
      EXPECT_LT(bound, 0.3 * size_at(ordinary, bin)) << bin;
      if (bound > off) {
        EXPECT_GT(std::abs(ordinary[bin] + 2 * bound + 2 * off - value), bound) << bin;
      }
    }
  }
}

}  // namespace
}  // namespace tubefoot
