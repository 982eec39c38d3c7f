// SPDX-License-Identifier: GPL-3.0-or-later
// Tests paths with more than one scattering (docs/notes/multiple-paths.md). The comparisons are sums over all
// pairs and triples of points with a ray for each leg, and a sphere, whose echoes have closed forms.
#include "engine/paths/patch_paths.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <memory>
#include <numbers>
#include <numeric>
#include <optional>

#include "engine/paths/path_echo.hpp"
#include "fixtures/world/path_scenes.hpp"
#include "fixtures/world/point_sum.hpp"

namespace tubefoot {
namespace {

using namespace test;

TEST(PatchPaths, TwoScatteringsByAnyLawAgreeWithTheDoubleSum) {
  Setting s = plates(false);
  s.paths.patch_m = 0.15;
  const std::shared_ptr<const ScatteringModel>
      gsab = std::make_shared<ScatteringModel>(
          ScatteringModel::gsab({.specular = 0.1, .specular_width_rad = 0.3, .oblique = 0.02})),
      table = std::make_shared<ScatteringModel>(
          ScatteringModel::table(std::vector<double>{10, 40, 70}, std::vector<double>{-30, -12, -9}));
  for (const auto& [first, second] : {std::pair(gsab, table), std::pair(table, gsab),
                                      std::pair(gsab, std::shared_ptr<const ScatteringModel>())}) {
    s.scattering = {first, second};
    expect_near(s.run().by_order[2], PointSum(s, 16, std::nullopt).scattered_twice(), 0.005, 0.01, "laws");
  }
}

// The sonar looks up, so that each path begins and ends at the surface. With two scatterings between, the
// order is 4.
TEST(PatchPaths, MirrorScatterScatterMirrorAgreesWithBruteForceRays) {
  Setting s = plates(true);
  s.transmit = around({-0.5, 0.25, -2}, 10, 89.99, 3, 60, 4);
  s.receive = around({0.8, -0.5, -1.75}, 10, 89.99, 3, 60, 4);
  s.samples = {5, 0.5, 14};
  s.paths.order = 4;
  s.paths.mirrors.surface = SeaSurface{0, 0.7, 0};
  const PathEcho paths = s.run();
  EXPECT_EQ(total(paths.by_order[2]), 0);
  EXPECT_GT(total(paths.by_order[3]), 0);  // scattered once
  expect_near(paths.by_order[4], PointSum(s, 12, 0.7).scattered_twice(), 0.01, 0.015, "surface");
}

TEST(PatchPaths, ThreeScatteringsAgreeWithTheTripleSum) {
  Setting s = plates(true);
  s.paths.order = s.paths.scatterings = 3;
  const PathEcho paths = s.run();
  const PointSum sum(s, 8, std::nullopt);
  expect_near(paths.by_order[2], sum.scattered_twice(), 0.02, 0.02, "two");
  expect_near(paths.by_order[3], sum.scattered_thrice(), 0.03, 0.03, "three");
}

/// A sonar in the middle of a sphere of 128 facets, or of its lower half.
Setting in_a_sphere(bool bowl, int scatterings) {
  Setting s;
  const auto add = [&](auto&& self, glm::dvec3 a, glm::dvec3 b, glm::dvec3 c, int left) -> void {
    if (left == 0) return add_triangle(s.mesh, 2.0 * a, 2.0 * b, 2.0 * c, 0);
    const glm::dvec3 ab = glm::normalize(a + b), bc = glm::normalize(b + c), ca = glm::normalize(c + a);
    self(self, a, ab, ca, left - 1);
    self(self, ab, b, bc, left - 1);
    self(self, ca, bc, c, left - 1);
    self(self, ab, bc, ca, left - 1);
  };
  for (const double x : {-1, 1})
    for (const double y : {-1, 1})
      for (const double z : {-1, 1})
        if (z < 0 || !bowl) add(add, {x, 0, 0}, {0, y, 0}, {0, 0, z}, 2);
  test::weld(s.mesh);
  s.transmit = s.receive = around({0, 0, 0.01}, -89.9, 89.9, 3, 60, 4);
  s.samples = {1, 0.25, 50};
  s.mu = {0.2};
  s.absorption_db_per_m = 0;
  s.paths.order = s.paths.scatterings = scatterings;
  s.paths.patch_m = 2;
  return s;
}

// sin sin / r^2 is 1 / (4 a^2) between any two points of a sphere of radius a. Thus the first scattering
// insonifies the whole sphere uniformly. Each further scattering costs the albedo and takes a mean chord, 4
// a / 3. From half a sphere, the share that leaves equals the ratio of the opening to the area
// (reciprocity). Facets do not insonify themselves, so that this is approximate.
TEST(PatchPaths, InASphereEveryScatteringMoreCostsTheAlbedo) {
  for (const bool bowl : {false, true}) {
    const Setting s = in_a_sphere(bowl, 5);
    double area = 0;
    for (const auto& [i, j, k] : s.mesh.facets) {
      const glm::dvec3 a = metres(s.mesh.vertices[i]);
      area += glm::length(glm::cross(metres(s.mesh.vertices[j]) - a, metres(s.mesh.vertices[k]) - a)) / 2;
    }
    const double opening = bowl ? 8 * 4 * std::sin(pi / 8) : 0, kept = 1 - opening / area;
    const double a = std::sqrt(area / (bowl ? 2 : 4) / pi), first = (bowl ? 0.5 : 1) * 4 * pi * 0.2 / (a * a);
    EXPECT_NEAR(kept, bowl ? 0.5 : 1, 0.02);
    const PathEcho paths = s.run();
    if (bowl) {
      Setting finer = in_a_sphere(true, 2);
      finer.paths.patch_m = 0.7;
      EXPECT_NEAR(total(paths.by_order[2]), total(finer.run().by_order[2]), 0.006 * total(paths.by_order[2]));
    }
    double before = first, mean_before = 0;
    for (int n = 2; n <= 5; ++n) {
      const double energy = total(paths.by_order[n]);
      EXPECT_NEAR(energy / before, pi * 0.2 * kept,
                  (bowl    ? 0.02
                   : n > 2 ? 0.001
                           : 0.012) *
                      energy / before)
          << bowl << ' ' << n;
      before = energy;
      if (bowl) continue;
      double mean = 0;
      for (int k = 0; k < s.samples.count; ++k)
        mean += (s.samples.first_m + (k + 0.5) * s.samples.step_m) * paths.by_order[n].at(0, k) / energy;
      EXPECT_NEAR(mean, a + (n - 1) * 2 * a / 3, 0.02 * mean) << n;
      if (n > 2) {
        EXPECT_NEAR(mean - mean_before, 2 * a / 3, 0.03) << n;
      }
      mean_before = mean;
    }
  }
}

TEST(PatchPaths, TheCutOffEndsThePathsAndDropsNoMoreThanItSays) {
  Setting s = in_a_sphere(false, 5);
  const PathEcho all = s.run();
  s.paths.cutoff_db = 13;
  const PathEcho some = s.run();
  EXPECT_LT(some.patches, all.patches);
  const double part = std::pow(10, -1.3);
  for (int n = 2; n <= 5; ++n) {
    const double missing = total(all.by_order[n]) - total(some.by_order[n]);
    EXPECT_GE(missing, 0) << n;
    EXPECT_LE(missing, (n - 1) * part * total(all.by_order[2])) << n;
  }
  // With an albedo of 3 %, the cut-off keeps the second generation. The third generation is below 1 % of
  // the first.
  s.mu = {0.01};
  s.paths.cutoff_db = 20;
  const PathEcho dark = s.run();
  EXPECT_GT(total(dark.by_order[3]), 0);
  EXPECT_EQ(total(dark.by_order[4]), 0);
}

TEST(PatchPaths, ThreadsChangeNothing) {
  const Setting s = in_a_sphere(true, 4);
  const PathEcho many = s.run();
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const PathEcho alone = s.run();
  for (std::size_t n = 0; n < many.by_order.size(); ++n)
    EXPECT_EQ(many.by_order[n].energy, alone.by_order[n].energy) << n;
}

}  // namespace
}  // namespace tubefoot
