// SPDX-License-Identifier: GPL-3.0-or-later
// Tests laws of paths that hold in every scene (docs/notes/multiple-paths.md): energy, reciprocity and
// limits. A bowl is also compared with brute-force rays.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <memory>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "engine/paths/path_echo.hpp"
#include "fixtures/world/path_scenes.hpp"
#include "fixtures/world/point_sum.hpp"

namespace tubefoot {
namespace {

using namespace test;

/// A paraboloid bowl with the rim at z = 0 and a fin inside that hides parts of the bowl from each other.
/// The sonar looks over the rim, which hides the near side. The receiver is separate.
Setting bowl() {
  Setting s;
  constexpr int rings = 3, sectors = 9;
  const auto point = [](int ring, int sector) {
    const double r = double(ring) / rings, turn = 2 * pi * sector / sectors + 0.1;
    return glm::dvec3(r * std::cos(turn), r * std::sin(turn), 0.9 * (r * r - 1));
  };
  for (int k = 0; k < sectors; ++k) {
    add_triangle(s.mesh, point(0, 0), point(1, k), point(1, k + 1));
    for (int ring = 1; ring < rings; ++ring) {
      add_triangle(s.mesh, point(ring, k), point(ring + 1, k), point(ring + 1, k + 1));
      add_triangle(s.mesh, point(ring, k), point(ring + 1, k + 1), point(ring, k + 1));
    }
  }
  add_triangle(s.mesh, {0.1, 0.05, -0.7}, {0.5, 0.2, -0.2}, {-0.1, 0.5, -0.15}, 1);
  test::weld(s.mesh);
  const glm::dvec3 middle(0, 0, -0.4);
  s.transmit = towards({1.8, -0.4, 0.8}, middle, 42, 3, 20);
  s.receive = towards({-0.6, -1.6, 1}, middle, 42, 3, 20);
  s.samples = {1, 0.25, 14};
  s.mu = {0.25, 0.1};
  s.reflection = {0, 0};
  s.paths.order = 2;
  s.paths.scatterings = 2;
  s.paths.patch_m = 0.15;
  return s;
}

// The double integral over all pairs of points, with a ray for each of the three legs.
TEST(PathLaws, ABowlsSecondEchoAgreesWithBruteForceRays) {
  const Setting s = bowl();
  const PointSum sum(s, 5, std::nullopt);
  // The rim hides some points from both ends.
  EXPECT_GT(sum.unlit(), 0.05);
  EXPECT_GT(sum.unreceived(), 0.05);
  const std::vector<double> expected = sum.scattered_twice();
  const double all = std::accumulate(expected.begin(), expected.end(), 0.0);
  const PathEcho paths = s.run();
  EXPECT_NEAR(total(paths.by_order[2]), all, 0.02 * all);
  for (int k = 0; k < s.samples.count; ++k)
    EXPECT_NEAR(paths.by_order[2].at(0, k), expected[k], 0.02 * all) << k;
}

TEST(PathLaws, TwoScatteringsGoWithTheAlbedoSquaredAndStayBelowTheFirst) {
  Setting s = bowl();
  s.receive = s.transmit;
  s.paths.patch_m = 1;
  double before = 0, first_before = 0;
  for (const double mu : {0.01, 0.1, 1 / pi}) {
    s.mu = {mu, mu};
    const double first = total(s.first_order(s.transmit, s.receive)), second = total(s.run().by_order[2]);
    EXPECT_GT(second, 0);
    EXPECT_LT(second, pi * mu * first) << mu;
    if (before > 0) {
      EXPECT_NEAR(second / before, std::pow(first / first_before, 2), 1e-6 * second / before);
    }
    before = second;
    first_before = first;
  }
}

// Between two horizontal mirrors paths get longer with each reflection, and each reflection costs the
// albedo.
TEST(PathLaws, OrdersOfAChannelFallByTheAlbedoAndTheirSumConverges) {
  Setting s;
  s.mesh = square_seabed(-20, 120);
  s.transmit = around({0, 0, -5}, -86, 86, 2, 250);
  s.receive = around({30, 5, -12}, -86, 86, 2, 250);
  s.samples = {10, 1, 100};
  s.mu = {0};
  s.paths.order = 6;
  s.paths.cutoff_db = 300;
  s.paths.direct = true;
  std::vector<double> whole;
  for (const double albedo : {1.0, 0.7, 0.3}) {
    s.reflection = {albedo};
    s.paths.mirrors.surface = SeaSurface{0, albedo, 0};
    const PathEcho paths = s.run();
    double sum = 0;
    for (int n = 0; n <= s.paths.order; ++n) {
      const double energy = total(paths.by_order[n]);
      EXPECT_GT(energy, 0);
      if (albedo == 1) whole.push_back(energy);
      EXPECT_NEAR(energy, std::pow(albedo, n) * whole[n], 1e-12 * energy) << n;
      // Order 0 has one path. Each other order has two.
      if (n > 0) {
        EXPECT_LT(energy, (n == 1 ? 2 : 1) * albedo * total(paths.by_order[n - 1])) << n;
      }
      sum += energy;
    }
    if (albedo < 1) {
      EXPECT_LT(sum, whole[0] * (1 + 2 * albedo / (1 - albedo)));
    }
  }
}

// Each additional reflection is one more factor, independent of other scattering. Paths with a single
// scattering keep it. The seabed is not a mirror here.
TEST(PathLaws, ScatteredOrdersFallByTheAlbedoOfTheirMirrors) {
  Setting s;
  s.mesh = square_seabed(-20, 60);
  s.transmit = s.receive = around({0, 0, -5}, -86, 86, 2, 120);
  s.samples = {10, 1, 45};
  s.paths.order = 4;
  s.paths.cutoff_db = 300;
  std::vector<double> whole;
  for (const double albedo : {1.0, 0.5, 0.1}) {
    s.mu = {0.02};
    s.reflection = {albedo};
    s.paths.mirrors.surface = SeaSurface{0, albedo, 0};
    const PathEcho with = s.run();
    s.mu = {0};
    const PathEcho specular_returns = s.run();
    for (int n = 2; n <= s.paths.order; ++n) {
      const double energy = total(with.by_order[n]) - total(specular_returns.by_order[n]);
      EXPECT_GT(energy, 0);
      if (albedo == 1)
        whole.push_back(energy);
      else
        EXPECT_NEAR(energy, std::pow(albedo, n - 1) * whole[n - 2], 1e-9 * whole[n - 2])
            << albedo << ' ' << n;
    }
  }
}

TEST(PathLaws, TransmitterAndReceiverMayChangePlaces) {
  Setting s;
  s.mesh = square_seabed(-4, 3);
  add_quad(s.mesh, {3.1, -2, -3.5}, {3.1, 2, -3.5}, {3.1, 2, -1}, {3.1, -2, -1}, 1);
  add_triangle(s.mesh, {-1, 0.5, -2.5}, {0.5, 1.5, -3}, {-0.5, 0, -1.5}, 0);
  s.transmit = around({-0.5, 0.25, -1}, -85, 85, 3, 40);
  s.receive = around({1, -1, -0.5}, -85, 85, 3, 40);
  s.samples = {0, 1, 20};
  s.mu = {0.1, 0.05};
  s.reflection = {0.3, 0.8};
  s.paths.order = 3;
  s.paths.mirrors.surface = SeaSurface{0, 0.9, 0.5};
  const PathEcho there = s.run();
  std::swap(s.transmit, s.receive);
  const PathEcho back = s.run();
  for (int n = 1; n <= s.paths.order; ++n) {
    EXPECT_GT(total(there.by_order[n]), 0) << n;
    for (int k = 0; k < s.samples.count; ++k)
      EXPECT_NEAR(there.by_order[n].at(0, k), back.by_order[n].at(0, k), 2e-7 * total(there.by_order[n]))
          << n << ' ' << k;
  }
}

constexpr ScatteringModel::Gsab hard_seabed{.specular = 0.05, .specular_width_rad = 0.4, .oblique = 0.01};

/// 1 + sin(k . place) / 2.
class Waves : public ReflectivityField {
 public:
  double factor(glm::dvec3 place_m) const override { return 1 + std::sin(glm::dot(number_, place_m)) / 2; }
  double largest() const override { return 1.5; }
  double finest_m() const override { return 2 * pi / glm::length(number_); }
  std::span<const CellPlanes> cells() const override { return {}; }
  double change(double away_m) const override {
    return std::sinh(std::min(glm::length(number_) * away_m, 50.0));
  }

 private:
  glm::dvec3 number_{0.7, -0.4, 0.2};
};

// With both legs over the surface, the echo is that of a sonar above the surface. It includes the
// scattering model and the texture of the seabed.
TEST(PathLaws, OverAMirrorTheSeabedHasItsTextureAndItsLaw) {
  for (const bool textured : {false, true}) {
    Setting s;
    s.mesh = square_seabed(-20, 200);
    s.transmit = s.receive = around({1.5, -2, -5}, -88, 88, 6, 120);
    s.samples = {27, 2, 10};
    s.mu = {0.01};
    s.reflection = {0};
    s.paths.order = 3;
    s.paths.mirrors.surface = SeaSurface{0, 0.6, 0};
    if (textured)
      s.texture = {std::make_shared<Waves>()};
    else
      s.scattering = {std::make_shared<ScatteringModel>(ScatteringModel::gsab(hard_seabed))};
    const TubeSet above = around({1.5, -2, 5}, -88, 88, 6, 120);
    const Echo image = s.first_order(above, above);
    const PathEcho paths = s.run();
    for (int k = 0; k < s.samples.count; ++k)
      EXPECT_NEAR(paths.by_order[3].at(0, k), 0.36 * image.at(0, k), 1e-6 * image.at(0, k))
          << textured << ' ' << k;
    // One leg goes up and the other straight, in both orders.
    const Echo once = s.first_order(s.transmit, above);
    for (int k = 0; k < s.samples.count; ++k)
      EXPECT_NEAR(paths.by_order[2].at(0, k), 2 * 0.6 * once.at(0, k), 1e-6 * once.at(0, k))
          << textured << ' ' << k;
  }
}

/// A mirror of n x n small squares, each at its own height.
Setting steps_of_mirrors(int n) {
  Setting s;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const double x = 10.0 * i / n - 5, y = 10.0 * j / n - 5, d = 10.0 / n, z = -10 + 0.01 * (i * n + j) / n;
      add_quad(s.mesh, {x, y, z}, {x + d, y, z}, {x + d, y + d, z}, {x, y + d, z});
    }
  s.transmit = s.receive = towards({0.1, 0.2, 0}, {0.1, 0.21, -10}, 40, 2, 60);
  s.samples = {8, 1, 20};
  s.mu = {0.001};
  s.reflection = {0.5};
  return s;
}

TEST(PathLaws, AMirrorOfManyFacetsIsFollowedOnceAndRefusedFurther) {
  Setting s = steps_of_mirrors(30);
  s.paths.most_images = 20;
  // Only the square directly below returns sound to the sonar.
  const PathEcho once = s.run();
  EXPECT_EQ(once.images, 1u);
  EXPECT_EQ(once.arrivals, 1u);
  s.paths.order = 2;
  EXPECT_THROW(s.run(), std::length_error);
  s = steps_of_mirrors(4);
  s.paths.order = 2;
  const PathEcho twice = s.run();
  EXPECT_EQ(twice.arrivals, 1u);
  s.paths.most_images = 16;
  EXPECT_NO_THROW(s.run());
  s.paths.most_images = 15;
  EXPECT_THROW(s.run(), std::length_error);
}

TEST(PathLaws, TooManyPairsOfImagesAreRefused) {
  // On a dome no facet sees another. The squares of an elliptic paraboloid are planar.
  Setting s = steps_of_mirrors(1);
  s.mesh = {};
  const auto point = [](int i, int j) {
    const double x = i / 2.0 - 4, y = j / 2.0 - 4;
    return glm::dvec3(x, y, -10 - (x * x + y * y) / 64);
  };
  for (int i = 0; i < 16; ++i)
    for (int j = 0; j < 16; ++j)
      add_quad(s.mesh, point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1));
  add_triangle(s.mesh, {-40, -40, 5}, {40, -40, 5}, {0, 60, 5}, 1);  // all images see this facet
  s.mu = {0, 0.1};
  s.reflection = {0.5, 0};
  s.paths.order = 3;
  s.paths.most_images = 300;
  try {
    s.run();
    ADD_FAILURE() << "256 images, 32896 pairs";
  } catch (const std::length_error& error) {
    EXPECT_NE(std::string(error.what()).find("30000 pairs"), std::string::npos) << error.what();
  }
}

// Patches are larger than any facet, so that each visible facet has one patch, for any number of tubes.
TEST(PathLaws, PatchesDoNotDependOnTheTubes) {
  Setting s = bowl();
  s.paths.patch_m = 3;
  const PathEcho few = s.run();
  s.transmit = towards(metres(s.transmit.apex), {0, 0, -0.4}, 42, 12, 20);
  const PathEcho many = s.run();
  EXPECT_EQ(many.patches, few.patches);
  EXPECT_NEAR(total(many.by_order[2]), total(few.by_order[2]), 1e-4 * total(few.by_order[2]));
}

}  // namespace
}  // namespace tubefoot
