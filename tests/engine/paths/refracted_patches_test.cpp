// SPDX-License-Identifier: GPL-3.0-or-later
// Tests paths with more than one scattering in stratified water (docs/notes/multiple-paths.md). Gradients are
// a thousand times those of the sea. Thus scenes of some metres refract rays as much as the sea does over
// kilometres.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

#include "engine/paths/patches.hpp"
#include "fixtures/world/refracted_rays.hpp"

namespace tubefoot {
namespace {

using namespace test;

// Validates the oracle by a ray that is integrated in steps from the direction of an arc. The ray arrives
// at the end of the arc, at its time and angle. The tube area is that of rays in closed form.
TEST(RefractedPatches, ArcsAreRays) {
  const unsigned seed = 6;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> any(0, 1);
  for (const double g : {-0.9, 0.7})
    for (int n = 0; n < 20; ++n) {
      const Arcs arcs{1500, g};
      const glm::dvec3 from{0, 0, -5 - 20 * any(random)},
          to{30 + 20 * any(random), 15, -5 - 40 * any(random)};
      const Ray ray = arcs(from, to);
      Setting s;
      add_quad(s.mesh, to + glm::dvec3(0, -3, -3), to + glm::dvec3(0, 3, -3), to + glm::dvec3(0, 3, 3),
               to + glm::dvec3(0, -3, 3));
      s.reflection = {0};
      const Circles circles{1500, g};
      const auto met = Stepped{s, circles}.follow(from, ray.launch, 0);
      ASSERT_EQ(met.size(), 1u);
      EXPECT_LT(glm::distance(met[0].at, to), 2e-3);
      EXPECT_LT(glm::distance(met[0].along, ray.arrival), 1e-3);
      EXPECT_NEAR(met[0].t * c_ref, ray.way_m, 2e-3);
      const double x = glm::length(glm::dvec2(to - from));
      if (std::abs(ray.launch.z) < 0.2 || std::abs(ray.arrival.z) < 0.2 || ray.launch.z * ray.arrival.z < 0)
        continue;  // the ray turns, or nearly
      EXPECT_NEAR(circles.to(x, -from.z, {}, -to.z).area / ray.tube_area_m2, 1, 1e-5);
    }
}

// Patches by rays through isovelocity water equal those by straight lines. They are cut differently, so
// that they agree to the error of patches.
TEST(RefractedPatches, IsovelocityWaterIsTheStraightEngine) {
  const WaterColumn even{SoundSpeedProfile({{0, c_ref}, {8, c_ref}}), {0.3, 0.3, 0.3}};
  Setting s = plates(true);
  s.paths.order = s.paths.scatterings = 3;
  s.paths.mirrors.surface = SeaSurface{0, 0.7, 0.4};
  const PathEcho straight = s.run(), refracted = through(through_water(even), s);
  EXPECT_EQ(refracted.seen_by_patches.in_shadow, 0u);
  EXPECT_EQ(refracted.seen_by_patches.folded, 0u);
  for (std::size_t order = 2; order < 4; ++order)
    expect_near(refracted.by_order[order], straight.by_order[order].energy, 2e-3, 2e-3, "even");
}

// The deviation is of first order in the gradient.
TEST(RefractedPatches, AGradientThatGoesToZeroLeavesIsovelocityWater) {
  Setting s = plates(false);
  const auto at = [&](double g) {
    const WaterColumn column = column_of({1500 - 4 * g, g, s.absorption_db_per_m});
    return total(through(through_water(column, 1), s).by_order[2]);
  };
  const double even = at(1e-9), whole = at(4) / even - 1, half = at(2) / even - 1;
  EXPECT_GT(std::abs(whole), 1e-4);
  EXPECT_NEAR(whole / half, 2, 0.05);
}

TEST(RefractedPatches, TwoAndThreeScatteringsAgreeWithSumsOverPoints) {
  for (const double g : {-60.0, 60.0}) {
    SCOPED_TRACE(g);
    Setting s = plates(true);
    s.paths.order = s.paths.scatterings = 3;
    const Arcs arcs{1500 - 3 * g, g, s.absorption_db_per_m};
    const PathEcho paths = through(through_water(column_of(arcs)), s), straight = s.run();
    const PointSum sum(s, 8, arcs, arcs);
    expect_near(paths.by_order[2], sum.scattered_twice(), 0.01, 0.01, "two");
    // Delays are stored in steps of a range bin. This blurs the ends of the bins, as in isovelocity water.
    expect_near(paths.by_order[3], sum.scattered_thrice(), 0.01, 0.04, "three");
    // Refraction has an effect on this.
    EXPECT_GT(std::abs(total(straight.by_order[2]) / total(paths.by_order[2]) - 1), 0.05);
  }
}

// Each path begins and ends at the surface.
TEST(RefractedPatches, MirrorScatterScatterMirrorAgreesWithSumsOverPoints) {
  Setting s = plates(true);
  s.transmit = around({-0.5, 0.25, -2}, 10, 89.99, 3, 60, 4);
  s.receive = around({0.8, -0.5, -1.75}, 10, 89.99, 3, 60, 4);
  s.samples = {5, 0.5, 14};
  s.paths.order = 4;
  s.paths.mirrors.surface = SeaSurface{0, 0.7, 0};
  const double g = -50;
  const Arcs arcs{1700, g, s.absorption_db_per_m};
  const ArcsBySurface by_surface{{1700, g}, 0.7, s.absorption_db_per_m};
  const PathEcho paths = through(through_water(column_of(arcs)), s);
  EXPECT_EQ(total(paths.by_order[2]), 0);
  expect_near(paths.by_order[4], PointSum(s, 12, arcs, by_surface).scattered_twice(), 0.02, 0.02, "surface");
}

// The values of a range bin do not depend on the length of the recording, for any sound speed relative to
// the reference speed.
TEST(RefractedPatches, ALongerRecordHoldsAShorterOne) {
  Setting s;  // A seabed, and a wall near the sonar that insonifies it from the same side.
  add_quad(s.mesh, {0, -0.5, -5}, {4, -0.5, -5}, {4, 0.5, -5}, {0, 0.5, -5});
  add_quad(s.mesh, {-0.3, -0.5, -5}, {-0.3, 0.5, -5}, {-0.3, 0.5, -4.5}, {-0.3, -0.5, -4.5});
  s.transmit = s.receive = around({0, 0, -4.6}, -89.99, 20, 3, 60, 4);
  s.mu = {0.1};
  s.paths.order = s.paths.scatterings = 2;
  s.paths.patch_m = 1;
  s.samples = {0.25, 0.1, 100};
  const WaterColumn column = column_of({1500, -60, s.absorption_db_per_m});
  const PathWater water = through_water(column, 0.1);
  const std::vector<double> whole = through(water, s).by_order[2].energy;
  double held = 0;
  for (int count = 10; count < 40; count += 3) {
    s.samples.count = count;
    const std::vector<double> part = through(water, s).by_order[2].energy;
    for (std::size_t k = 0; k < part.size(); ++k) {
      EXPECT_NEAR(part[k], whole[k], 1e-9 * whole[k]) << count << ' ' << k;
      held += part[k];
    }
  }
  EXPECT_GT(held, 0);
}

// A flat seabed insonifies itself where rays bend downwards, and does not where they bend upwards.
TEST(RefractedPatches, AFlatSeabedIsLitByItselfAlongRaysThatTurn) {
  for (const double g : {-60.0, 60.0}) {
    Setting s;
    s.mesh = square_seabed(-5, 1.2);
    s.transmit = s.receive = around({0.3, 0.2, -3}, -89.9, -20, 3, 60, 4);
    s.samples = {1, 0.5, 20};
    s.mu = {0.2};
    s.paths.order = s.paths.scatterings = 2;
    s.paths.patch_m = 0.25;
    const Arcs arcs{1500 - 3 * g, g};
    const PathEcho paths = through(through_water(column_of(arcs), 1e-3), s);
    EXPECT_EQ(paths.seen_by_patches.in_shadow, 0u);
    if (g > 0) {
      EXPECT_EQ(total(paths.by_order[2]), 0);
    } else {
      expect_near(paths.by_order[2], PointSum(s, 24, arcs, arcs).scattered_twice(), 0.03, 0.03, "bed");
    }
  }
}

// After an exchange of transmitter and receiver the energies differ by the square of the ratio of the sound
// speeds at the ends.
TEST(RefractedPatches, TransmitterAndReceiverExchangePlaces) {
  Setting s = plates(true);
  s.receive = around({-0.25, -0.5, -3.5}, -89.99, 20, 3, 60, 4);
  s.paths.patch_m = 0.15;
  Setting back = s;
  std::swap(back.transmit, back.receive);
  const double g = -60;
  const Arcs arcs{1500 - 3 * g, g, s.absorption_db_per_m};
  const WaterColumn column = column_of(arcs);
  const PathEcho there = through(through_water(column), s), rx = through(through_water(column), back);
  const double speeds = std::pow((arcs.c0 + 2 * g) / (arcs.c0 + 3.5 * g), 2);
  std::vector<double> expected = rx.by_order[2].energy;
  for (double& energy : expected) energy *= speeds;
  EXPECT_GT(speeds, 1.1);
  expect_near(there.by_order[2], expected, 5e-3, 5e-3, "exchanged");
}

// From a point on any wall of a closed box with a tilted wall, all sound of Lambert's law arrives exactly
// once. The wall itself hides nothing and no direction is lost, for any refraction.
TEST(RefractedPatches, AllThatLambertsLawSendsArrivesOnce) {
  FacetMesh box;
  const glm::dvec3 middle(0, 0, -4);
  const auto corner = [&](int k) {
    const glm::dvec3 p(k & 1 ? 2 : -2, k & 2 ? 1.3 : -1.3, k & 4 ? 1.7 : -1.7);
    return middle + p + glm::dvec3(0.17 * p.z, 0.11 * p.x, 0.13 * p.y);
  };
  for (const auto& [a, b, c, d] : std::vector<std::array<int, 4>>{
           {0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}})
    add_quad(box, corner(a), corner(b), corner(c), corner(d));
  test::weld(box);
  const SceneTree tree(box);
  for (const double g : {-80.0, 80.0}) {
    const WaterColumn column = continued_below(column_of({1500 - 4 * g, g}), 6, 20);
    PathWater water = through_water(column, 1e-3);
    water.rays.deepest_turn_m = std::numeric_limits<double>::infinity();
    const Mirrors none;
    const RefractedImages seabed(box, tree, VisibilityOptions(), none, 0, 10, 0, water,
                                 {around(middle, -80, 80, 1, 30)}, 1);
    for (FacetId facet = 0; facet < box.facets.size(); ++facet) {
      glm::dvec3 c[3];
      for (std::size_t k = 0; k < 3; ++k) c[k] = metres(box.vertices[box.facets[facet][k]]);
      glm::dvec3 normal = glm::normalize(glm::cross(c[1] - c[0], c[2] - c[0]));
      if (glm::dot(normal, middle - c[0]) < 0) normal = -normal;
      // Close to an edge: the adjacent wall is 5 cm away.
      const glm::dvec3 place = 0.6 * c[0] + 0.38 * c[1] + 0.02 * c[2];
      const GridPoint apex = in_front(box, facet, at(middle), (place - middle) / unit, normal, 4);
      RefractedImages from(seabed, water, front_tubes(apex, normal, 30 / unit), 1, {normal, 0.25});
      const std::vector<Image> images = from.images_of(0);
      ASSERT_EQ(images.size(), 1u);
      const VisibleSurface seen = from.seen_by(images[0]);
      double sum = 0, own = 0;
      for (const RadiosityPatch& patch : patches_of(from.base(), apex, seen, unit, 0.5, {}, normal)) {
        sum += patch.projected_sr;
        if (patch.facet / 2 == facet / 2) own += patch.projected_sr;
      }
      EXPECT_NEAR(sum, pi, 2e-4 * pi) << g << ", facet " << facet;
      EXPECT_LT(own, 0.03 * pi) << g << ", facet " << facet;  // by rays that turn
      EXPECT_EQ(from.counts({&seen, 1}).in_shadow, 0u);
    }
  }
}

// Rays do not turn above the surface. Directly under the surface, where rays bend downwards, two walls do
// not see each other, and the engine reports this. Facets in the plane of a wall itself make no shadow.
TEST(RefractedPatches, ShadowsBeforeAPatchAreCounted) {
  FacetMesh walls;
  for (double top = -0.02; top > -1; top -= 0.1)
    for (const double x : {-2.0, 2.0})
      add_quad(walls, {x, -0.1, top - 0.1}, {x, 0.1, top - 0.1}, {x, 0.1, top}, {x, -0.1, top});
  const SceneTree tree(walls);
  const WaterColumn column = column_of({1800, -60});
  const PathWater water = through_water(column, 1e-3);
  const Mirrors none;
  const RefractedImages seabed(walls, tree, VisibilityOptions(), none, 0, 10, 0, water,
                               {around({0, 0, -4}, -80, 80, 1, 30)}, 1);
  const glm::dvec3 normal(1, 0, 0);
  for (const double depth : {0.05, 0.9}) {
    const GridPoint apex = at({-2 + 4 * unit, 0.01, -depth});
    RefractedImages from(seabed, water, front_tubes(apex, normal, 30 / unit), 1, {normal, 0.05});
    const std::vector<Image> images = from.images_of(0);
    const VisibleSurface seen = from.seen_by(images.at(0));
    const SurfaceCounts counts = from.counts({&seen, 1});
    // Chords of 4 m need (4 m)^2 / 8 g / c = 7 cm of water above them.
    EXPECT_EQ(counts.in_shadow > 0, depth < 0.07) << depth;
    if (counts.in_shadow > 0) {
      ASSERT_EQ(counts.unclear.size(), 1u);
      EXPECT_NEAR(counts.unclear[0].at_m.x, 2, 1e-6);
      EXPECT_EQ(counts.unclear[0].eigenrays, 0);
    }
    EXPECT_EQ(counts.folded, 0u);
  }
}

}  // namespace
}  // namespace tubefoot
