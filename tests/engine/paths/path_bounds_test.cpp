// SPDX-License-Identifier: GPL-3.0-or-later
// Tests certified energies of paths over mirrors. The comparisons are the ordinary energies, the scene with
// the image of the receiver, and closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/certified/reference.hpp"
#include "engine/paths/path_echo.hpp"
#include "fixtures/world/path_scenes.hpp"

namespace tubefoot {
namespace {

using namespace test;

/// A sloping seabed with a block on it, below the sea surface at z = 0.
Setting basin() {
  Setting s;
  add_quad(s.mesh, {-9, -9, -9}, {9, -9, -7.5}, {9, 9, -7}, {-9, 9, -8.5});
  add_quad(s.mesh, {1, -1, -8}, {2.5, -1, -8}, {2.5, 1, -6.5}, {1, 1, -6.5});
  test::weld(s.mesh);
  s.transmit = around({0, 0, -4}, -89, 89, 2, 60, 4);
  s.receive = around({-1.5, 1, -5}, -89, 89, 2, 60, 4);
  s.samples = {0.5, 0.75, 22};
  s.mu = {0.01};
  s.paths.order = 3;
  s.paths.mirrors.surface = SeaSurface{0, 0.8, 0.5};
  s.paths.direct = true;
  s.absorption_db_per_m = 0.05;
  return s;
}

void expect_holds(const PathEcho& ordinary, const PathEcho& reference, double tolerance) {
  ASSERT_EQ(reference.bound_by_order.size(), ordinary.by_order.size());
  EXPECT_EQ(reference.arrivals, ordinary.arrivals);
  for (std::size_t order = 0; order < ordinary.by_order.size(); ++order) {
    const auto &plain = ordinary.by_order[order].energy, &proven = reference.by_order[order].energy,
               &bound = reference.bound_by_order[order];
    const double most = *std::max_element(plain.begin(), plain.end());
    EXPECT_GT(most, 0) << order;
    for (std::size_t k = 0; k < plain.size(); ++k) {
      EXPECT_LE(std::abs(plain[k] - proven[k]), bound[k] + 1e-9 * plain[k] + 1e-14 * most)
          << order << ' ' << k;
      EXPECT_LE(bound[k], tolerance * std::max(proven[k], 1e-5 * most)) << order << ' ' << k;
    }
  }
}

TEST(PathBounds, HoldTheOrdinaryEnergies) {
  Setting s = basin();
  const PathEcho ordinary = s.run();
  EXPECT_TRUE(ordinary.bound_by_order.empty());
  s.paths.reference_tolerance = 1e-3;
  expect_holds(ordinary, s.run(), 1e-3);
}

TEST(PathBounds, PatternsAtBothEndsAndMirrorFacets) {
  Setting s = basin();
  s.mesh = square_seabed(-8, 6);
  s.samples = {2, 1, 10};
  s.paths.order = 2;
  s.reflection = {0.3};
  BeamPatterns patterns;
  Directivity line{Directivity::Kind::line, {0, 0, 1}},
      gauss{Directivity::Kind::gaussian, {0.6, 0, -0.8}, true};
  line.size = 2;
  gauss.size = 0.8;
  patterns.transmit = {line};
  patterns.receive = {gauss};
  patterns.fan_of_tube.assign(s.receive.tubes.size(), 0);
  patterns.beams_of_tube.assign(s.receive.tubes.size(), {0, 1});
  const PathEcho ordinary = s.run(&patterns);
  s.paths.reference_tolerance = 1e-2;
  const PathEcho reference = s.run(&patterns);
  for (std::size_t order = 0; order <= 2; ++order)
    for (std::size_t k = 0; k < ordinary.by_order[order].energy.size(); ++k) {
      const double plain = ordinary.by_order[order].energy[k],
                   most = *std::max_element(ordinary.by_order[order].energy.begin(),
                                            ordinary.by_order[order].energy.end());
      EXPECT_LE(std::abs(plain - reference.by_order[order].energy[k]),
                reference.bound_by_order[order][k] + 1e-8 * plain + 1e-10 * most)
          << order << ' ' << k;
    }
}

// The mirror image of the receiver, without a mirror, receives the same energies except for the reflection
// loss of the surface.
TEST(PathBounds, AMirrorIsTheImageScene) {
  Setting s = basin();
  s.mesh = square_seabed(-8, 30);
  s.paths.mirrors.surface = SeaSurface{0, 0.5, 0};
  s.paths.order = 2;
  s.paths.direct = false;
  s.paths.reference_tolerance = 1e-5;
  const PathEcho over = s.run();
  const SceneTree tree(s.mesh);
  std::vector<double> energy(std::size_t(s.samples.count)), bound = energy;
  const auto add = [&](glm::dvec3 tx, glm::dvec3 rx) {
    const TubeSet there = around(tx, -89, -1, 2, 60, 4), back = around(rx, -89, -1, 2, 60, 4);
    const BistaticHistory history = trace_bistatic(s.mesh, tree, unit, {}, there, back);
    const std::vector<std::uint32_t> beam(back.tubes.size(), 0);
    const EchoModel model = s.model(there);
    const Echo ordinary = integrate_echo(history, {1, beam}, s.samples, model);
    const CertifiedEcho found = certify_echo(s.mesh, history, {1, beam}, s.samples, model, ordinary, 1e-5);
    for (std::size_t k = 0; k < energy.size(); ++k) {
      energy[k] += 0.5 * found.echo.energy[k];
      bound[k] += 0.5 * found.bound[k];
    }
  };
  add({0, 0, -4}, {-1.5, 1, 5});
  add({0, 0, 4}, {-1.5, 1, -5});
  // The comparison is limited to paths that reach the seabed at more than a degree below the horizon of the
  // images. All these paths fall within the range bins.
  for (std::size_t k = 0; k < energy.size(); ++k) {
    const double found = over.by_order[2].energy[k];
    EXPECT_LE(std::abs(found - energy[k]), bound[k] + over.bound_by_order[2][k] + 1e-12 * found) << k;
  }
  EXPECT_GT(total(over.by_order[2]), 0);
}

TEST(PathBounds, ArrivalsAreTheClosedFormInOneSampleOrOnTheBorderOfTwo) {
  Setting s = basin();
  s.mesh = square_seabed(-50, 1);
  s.mu = {0};
  s.paths.order = 1;
  s.paths.direct = false;
  s.paths.mirrors.surface = SeaSurface{0, 0.5, 0};
  s.receive = around({5, 0, -8}, -89, 89, 2, 60, 4);  // 4 m up and 8 m down: 5-12-13
  s.paths.reference_tolerance = 1e-9;
  const double energy = 0.5 * std::pow(10, -0.05 * 13 / 10) / 169;
  s.samples = {2, 0.75, 12};
  PathEcho paths = s.run();
  ASSERT_EQ(paths.arrivals, 1u);
  EXPECT_NEAR(paths.by_order[1].energy[6], energy, 1e-15 * energy + paths.bound_by_order[1][6]);
  EXPECT_GT(paths.bound_by_order[1][6], 0);
  EXPECT_LT(paths.bound_by_order[1][6], 1e-14 * energy);
  EXPECT_NEAR(total(paths.by_order[1]), energy, 1e-14 * energy);
  // An arrival on an exact bin border falls into the bin that begins there.
  s.samples = {5.5, 1, 2};
  paths = s.run();
  EXPECT_LE(std::abs(paths.by_order[1].energy[1] - energy), paths.bound_by_order[1][1] + 1e-15 * energy);
  EXPECT_LE(paths.by_order[1].energy[0], paths.bound_by_order[1][0]);
  EXPECT_LE(paths.bound_by_order[1][0], energy);
}

TEST(PathBounds, TwoScatteringsAreRefused) {
  Setting s = basin();
  s.paths.scatterings = 2;
  s.paths.reference_tolerance = 1e-3;
  EXPECT_THROW(s.run(), std::invalid_argument);
}

}  // namespace
}  // namespace tubefoot
