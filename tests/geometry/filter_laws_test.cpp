// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <vector>

#include "fixtures/geometry/exact_oracles.hpp"
#include "fixtures/geometry/layered_scenes.hpp"
#include "geometry/visibility/candidate_facets.hpp"
#include "geometry/visibility/gnomonic_frame.hpp"

// Tests filters in doubles against rationals: each decision that a filter reports as certain is correct.
// The filters compare cones and select candidate facets.
namespace tubefoot {
namespace {

using namespace test;

Cone cone_of(const SeenFrom& facet) { return {facet.vertex.begin(), facet.vertex.end()}; }

/// Returns whether a convex cone has an interior.
bool is_solid(const Cone& cone) {
  for (std::size_t j = 1; j < cone.size(); ++j)
    for (std::size_t k = j + 1; k < cone.size(); ++k)
      if (scalar_product(cone[0], vector_product(cone[j], cone[k])) != 0) return true;
  return false;
}

// Laws K1, K2 and K3.
TEST(GnomonicFilters, WhatIsSureIsSo) {
  std::size_t apart = 0, covered = 0, inside = 0, outside = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed)
    for (const Scene& scene : all_scenes(seed)) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", " << scene.name);
      Random random(seed);
      const GnomonicFrame frame(rays_of(scene.tubes, 0));
      std::vector<FramedFacet> facets;
      std::vector<SeenFrom> exact;
      for (FacetId f = 0; f < scene.mesh.facets.size() && facets.size() < 40; ++f) {
        RangedFacet facet;
        if (!FacetCone::make(scene.mesh, f, scene.tubes.apex, facet.cone)) continue;
        facet.measure_ranges();
        facets.emplace_back(facet).place(frame);
        exact.push_back(seen_from(scene.mesh, f, scene.tubes.apex).value());
      }
      for (int k = 0; k < 300 && !facets.empty(); ++k) {
        const std::size_t a = random() % facets.size(), b = random() % facets.size();
        if (surely_apart(facets[a], facets[b])) {
          ++apart;
          EXPECT_FALSE(
              is_solid(clipped(cone_of(exact[a]), {exact[b].inward.begin(), exact[b].inward.end()})));
        }
        if (surely_covers(facets[a], facets[b])) {
          ++covered;
          for (const V3& wall : exact[a].inward)
            for (const V3& vertex : exact[b].vertex) EXPECT_GE(scalar_product(wall, vertex), 0);
        }
        if (facets[a].turn == 0) continue;
        const Bounds& box = facets[a].bounds;
        const auto between = [&](double lo, double hi) {
          return lo + (hi - lo) * uniform(random, 0, 1000) / 1000;
        };
        const glm::dvec2 p{between(box.x0, box.x1), between(box.y0, box.y1)};
        const glm::dvec3 rounded = frame.direction(p);  // by far less than the margin of the filters
        const V3 d{Q(rounded.x), Q(rounded.y), Q(rounded.z)};
        bool holds = true;
        for (const V3& wall : exact[a].inward) holds = holds && scalar_product(wall, d) >= 0;
        const int place = where(facets[a], p);
        inside += place > 0;
        outside += place < 0;
        if (place != 0) {
          EXPECT_EQ(place > 0, holds);
        }
      }
    }
  EXPECT_GT(apart, 3000u);
  EXPECT_GT(covered, 50u);
  EXPECT_GT(inside, 2000u);
  EXPECT_GT(outside, 2000u);
}

// Law K4, also in tubes of a few units of a grid of 2^30 whose rays differ in length.
TEST(GnomonicFilters, DirectionsReturnToTheirCoordinates) {
  double narrowest = 1;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const auto any = [&](int least, int most) { return uniform(random, least, most); };
    const GridPoint first{any(-(1 << 28), 1 << 28), any(-(1 << 28), 1 << 28), -(1 << 28)};
    const int side = 1 << any(1, 27);
    std::array<GridPoint, 4> rays{};
    for (int k = 0; k < 4; ++k) {
      const int times = any(1, 3);  // the length of the ray
      rays[k] = {times * (first.x + (k == 1 || k == 2 ? side : 0)), times * (first.y + (k >= 2 ? side : 0)),
                 times * first.z};
    }
    const GnomonicFrame frame(rays);
    ASSERT_TRUE(frame.tube().is_finite());
    const Bounds& tube = frame.tube();
    narrowest = std::min(narrowest, tube.x1 - tube.x0);
    for (int k = 0; k < 10; ++k) {
      const glm::dvec2 p{tube.x0 + (tube.x1 - tube.x0) * any(0, 1000) / 1000,
                         tube.y0 + (tube.y1 - tube.y0) * any(0, 1000) / 1000};
      glm::dvec2 again;
      ASSERT_TRUE(frame.project(frame.direction(p), 1, again));
      EXPECT_LE(glm::length(again - p), GnomonicFrame::margin * (1 + glm::length(p)));
    }
  }
  EXPECT_LT(narrowest, 1e-7);
}

// Law G1.
TEST(CandidateFacets, RefusesOnlyFacetsThatAWallHasNoVertexOf) {
  std::size_t admitted = 0, refused = 0;
  CandidateFacets candidate_facets;
  for (std::uint64_t seed = 11; seed <= 16; ++seed)
    for (const Scene& scene : all_scenes(seed)) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", " << scene.name);
      const SceneTree tree(scene.mesh);
      const auto tubes = static_cast<std::uint32_t>(scene.tubes.tubes.size());
      const auto pyramid = enclosing_pyramid(scene.tubes, 0, tubes);
      if (!pyramid) continue;
      candidate_facets.gather(scene.mesh, tree, scene.tubes.apex, scene.tubes.reach, *pyramid, false);
      for (std::uint32_t t = 0; t < tubes; ++t) {
        const std::array<GridPoint, 4> rays = rays_of(scene.tubes, t);
        const auto normal = [&](std::size_t k) { return cross(rays[k], rays[(k + 1) % 4]); };
        const std::array<CandidateFacets::Wall, 4> walls{
            CandidateFacets::Wall(normal(0)), CandidateFacets::Wall(normal(1)),
            CandidateFacets::Wall(normal(2)), CandidateFacets::Wall(normal(3))};
        for (std::size_t f = 0; f < candidate_facets.facets().size(); ++f) {
          if (candidate_facets.admits(f, walls)) {
            ++admitted;
            continue;
          }
          ++refused;
          bool outside = false;  // of one wall, whole
          for (std::size_t k = 0; k < 4; ++k) {
            bool none = true;
            for (const GridPoint& p : candidate_facets.facets()[f].cone.point)
              none = none && dot(normal(k), p) <= 0;
            outside = outside || none;
          }
          EXPECT_TRUE(outside) << "tube " << t;
        }
      }
    }
  EXPECT_GT(admitted, 2000u);
  EXPECT_GT(refused, 2000u);
}

}  // namespace
}  // namespace tubefoot
