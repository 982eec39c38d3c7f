// SPDX-License-Identifier: GPL-3.0-or-later
// Tests certified energies and products of a receiver pair over mirrors. The comparisons are ordinary
// energies and products, the scene with the images, and closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "engine/certified/receiver_pair_reference.hpp"
#include "engine/paths/receiver_pair_paths.hpp"
#include "fixtures/world/path_scenes.hpp"

namespace tubefoot {
namespace {

using namespace test;

const ReceiverBaseline slanting{glm::normalize(glm::dvec3(0.5, -0.2, 1)), 0.3, 12};

BeamPatterns even_patterns(const TubeSet& tubes) {
  return patterns_of_fan({{Directivity()}, {Directivity()}, {}, {}}, 0, tubes.tubes.size());
}

/// The receiver pair has its middle at `receive`.
ReceiverPairPathEcho run(const Setting& s, const ReceiverBaseline& receiver_pair,
                         const BeamPatterns& patterns) {
  const SceneTree tree(s.mesh);
  const std::vector<double> none(s.mu.size(), 0);
  PathSettings settings = s.paths;
  settings.mirrors.reflection = s.reflection.empty() ? none : s.reflection;
  return receiver_pair_path_echo(s.mesh, tree, unit, {}, {s.transmit, s.receive, receiver_pair}, s.samples,
                                 s.model(s.transmit, &patterns), settings);
}

/// A sloping seabed with a plate on it that is a mirror, below a rough surface at z = 0.
Setting basin(bool apart) {
  Setting s;
  add_quad(s.mesh, {-4, -4, -7}, {4, -4, -6}, {4, 4, -5.5}, {-4, 4, -6.5});
  add_quad(s.mesh, {2, -1.5, -5.5}, {2, 1.5, -5.6}, {2.6, 1.5, -3}, {2.6, -1.5, -2.9}, 1);
  s.transmit = s.receive = around({0, 0, -3}, -89, 89, 2, 40, 4);
  if (apart) s.receive = around({-1, 0.75, -4}, -89, 89, 2, 40, 4);
  s.samples = {2, 2.5, 4};
  s.mu = {0.01, 0.02};
  s.reflection = {0, 0.5};
  s.paths.order = 2;
  s.paths.mirrors.surface = SeaSurface{0, 0.8, 0.5};
  s.absorption_db_per_m = 0.05;
  return s;
}

/// `error`: error of the ordinary values, relative to the energies.
void expect_holds(const ReceiverPairPathEcho& ordinary, const ReceiverPairPathEcho& reference,
                  double tolerance, double error) {
  ASSERT_EQ(reference.bound_by_order.size(), ordinary.by_order.size());
  EXPECT_EQ(reference.arrivals, ordinary.arrivals);
  for (std::size_t order = 1; order < ordinary.by_order.size(); ++order) {
    const auto plain = rows_of(ordinary.by_order[order]).energy,
               proven = rows_of(reference.by_order[order]).energy,
               bound = rows_of(reference.bound_by_order[order]).energy;
    CertifiedEcho held{rows_of(reference.by_order[order]), bound};
    // several paths share a bin, and each keeps the tolerance
    compare_receiver_pair_with(held, 2 * tolerance);
    EXPECT_EQ(held.bins_over, 0u) << order << ' ' << held.worst_ratio;
    const std::size_t row = plain.size() / 4;
    const double most = *std::max_element(plain.begin(), plain.begin() + std::ptrdiff_t(row));
    EXPECT_GT(most, 0) << order;
    for (std::size_t k = 0; k < plain.size(); ++k) {
      const double size = std::max(plain[k % row], plain[row + k % row]);
      EXPECT_LE(std::abs(plain[k] - proven[k]), bound[k] + error * size + 1e-13 * most) << order << ' ' << k;
      EXPECT_LE(bound[k], 2 * tolerance * std::max(size, 1e-5 * most)) << order << ' ' << k;
      const double moved = plain[k] + 2.1 * bound[k] + 2 * error * size + 2e-13 * most;
      EXPECT_GT(std::abs(moved - proven[k]), bound[k]) << order << ' ' << k;
    }
  }
}

TEST(ReceiverPairPathBounds, HoldTheOrdinaryEnergiesAndProducts) {
  for (const bool apart : {false, true}) {
    SCOPED_TRACE(apart);
    Setting s = basin(apart);
    const BeamPatterns patterns = even_patterns(s.receive);
    const ReceiverPairPathEcho ordinary = run(s, slanting, patterns);
    EXPECT_TRUE(ordinary.bound_by_order.empty());
    s.paths.reference_tolerance = 1e-2;
    expect_holds(ordinary, run(s, slanting, patterns), 1e-2, 1e-7);
  }
}

TEST(ReceiverPairPathBounds, PatternsAtBothEnds) {
  Setting s = basin(true);
  s.mesh = square_seabed(-6, 3);
  s.samples = {3, 2, 2};
  s.paths.mirrors.surface->roughness = 0;
  Directivity sent{Directivity::Kind::line, {0.6, 0, 0.8}}, received{Directivity::Kind::line, {0, 0, 1}};
  sent.size = received.size = 0.6;  // zeros of the pattern would be corners
  BeamPatterns patterns = even_patterns(s.receive);
  patterns.transmit = {sent};
  patterns.receive = {received};
  const ReceiverPairPathEcho ordinary = run(s, slanting, patterns);
  s.paths.reference_tolerance = 5e-2;
  expect_holds(ordinary, run(s, slanting, patterns), 5e-2, 1e-6);
}

// The mirror images of the receiver pair and of the transmitter give the same products without a mirror,
// except for the reflection loss.
TEST(ReceiverPairPathBounds, AMirrorIsTheImageScene) {
  Setting s;
  s.mesh = square_seabed(-6, 12);
  s.transmit = around({0, 0, -3}, -89, 89, 2, 40, 4);
  s.receive = around({-1, 0.75, -4}, -89, 89, 2, 40, 4);
  s.samples = {4, 2, 3};
  s.mu = {0.01};
  s.paths.order = 2;
  s.paths.mirrors.surface = SeaSurface{0, 0.5, 0};
  s.paths.reference_tolerance = 1e-4;
  ReceiverBaseline receiver_pair = slanting;
  receiver_pair.wavenumber_rad_m = 15;
  const BeamPatterns patterns = even_patterns(s.receive);
  const ReceiverPairPathEcho over = run(s, receiver_pair, patterns);
  const SceneTree tree(s.mesh);
  std::vector<double> energy(12), bound(12);
  const auto add = [&](glm::dvec3 tx, glm::dvec3 rx, const ReceiverBaseline& of) {
    const TubeSet there = around(tx, -89, -1, 2, 40, 4), back = around(rx, -89, -1, 2, 40, 4);
    const ReceiverPairHistory history = trace_receiver_pair(s.mesh, tree, unit, {}, there, back, of);
    const BeamPatterns own = even_patterns(back);
    const EchoModel model = s.model(there, &own);
    const ReceiverPairEcho ordinary = integrate_receiver_pair_echo(history, of, 0, 0, s.samples, model);
    const CertifiedEcho found =
        certify_receiver_pair_echo(s.mesh, history, unit, of, s.samples, model, ordinary, 1e-4);
    for (std::size_t k = 0; k < energy.size(); ++k) {
      energy[k] += 0.5 * found.echo.energy[k];
      bound[k] += 0.5 * found.bound[k];
    }
  };
  ReceiverBaseline image = receiver_pair;
  image.axis.z = -image.axis.z;
  add({0, 0, -3}, {-1, 0.75, 4}, image);
  add({0, 0, 3}, {-1, 0.75, -4}, receiver_pair);
  const auto found = rows_of(over.by_order[2]).energy, found_bound = rows_of(over.bound_by_order[2]).energy;
  double turned = 0;
  for (std::size_t k = 0; k < energy.size(); ++k) {
    // The ends lie on the grid for energies over mirrors.
    const double rounded = 2e-6 * energy[k % 3];
    EXPECT_LE(std::abs(found[k] - energy[k]), bound[k] + found_bound[k] + rounded) << k;
    if (k >= 9) turned = std::max(turned, std::abs(found[k]));
  }
  EXPECT_GT(turned, 0.02 * *std::ranges::max_element(found));
}

// The middle of the receiver pair is 4 m up, 8 m down and 5 m aside: the path is 13 m long.
TEST(ReceiverPairPathBounds, ArrivalsHaveTheProductInClosedForm) {
  Setting s;
  s.mesh = square_seabed(-50, 1);
  s.mu = {0};
  s.transmit = around({0, 0, -4}, -89, 89, 2, 60, 4);
  s.receive = around({5, 0, -8}, -89, 89, 2, 60, 4);
  s.samples = {2.25, 0.75, 12};
  s.paths.order = 1;
  s.paths.mirrors.surface = SeaSurface{0, 0.5, 0};
  s.paths.reference_tolerance = 1e-9;
  s.absorption_db_per_m = 0.05;
  const ReceiverBaseline receiver_pair{{0, 0, 1}, 0.25, 500};
  const ReceiverPairPathEcho paths = run(s, receiver_pair, even_patterns(s.receive));
  ASSERT_EQ(paths.arrivals, 2u);
  const auto length = [](long double down) { return std::sqrt(25 + (4 + down) * (4 + down)); };
  const auto energy = [](long double way) { return 0.5L * std::pow(10.0L, -0.05L * way / 10) / (way * way); };
  const long double upper = length(7.875L), lower = length(8.125L),
                    size = std::sqrt(energy(upper) * energy(lower)), phase = 500 * (upper - lower);
  const std::vector<long double> expected{energy(upper), energy(lower), size * std::cos(phase),
                                          size * std::sin(phase)};
  const auto found = rows_of(paths.by_order[1]).energy, bound = rows_of(paths.bound_by_order[1]).energy;
  for (std::size_t row = 0; row < 4; ++row) {
    const std::size_t k = 12 * row + 5;
    const double off = double(std::abs((long double)found[k] - expected[row]));
    EXPECT_LE(off, bound[k] + 1e-16 * double(size)) << row;
    EXPECT_LT(bound[k], 1e-13 * double(size)) << row;
    EXPECT_GT(bound[k], 0) << row;
  }
  // One receiver's arrival lies below a bin border and the other's above: their product is zero.
  s.samples = {5.5, 1, 2};
  const ReceiverPairPathEcho apart = run(s, receiver_pair, even_patterns(s.receive));
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_GT(k == 0 ? apart.by_order[1].upper_j[k] : apart.by_order[1].lower_j[k], 0);
    EXPECT_EQ(apart.by_order[1].cross_real_j[k], 0) << k;
    EXPECT_EQ(apart.bound_by_order[1].cross_real_j[k], 0) << k;
  }
}

TEST(ReceiverPairPathBounds, TwoScatteringsAreRefused) {
  Setting s = basin(false);
  s.paths.scatterings = 2;
  s.paths.reference_tolerance = 1e-3;
  EXPECT_THROW(run(s, slanting, even_patterns(s.receive)), std::invalid_argument);
}

}  // namespace
}  // namespace tubefoot
