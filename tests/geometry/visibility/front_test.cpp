// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/visibility/front.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "fixtures/geometry/layered_scenes.hpp"
#include "fixtures/geometry/looks.hpp"
#include "geometry/visibility/candidate_facets.hpp"

// Tests that the front of a pyramid rejects only boxes of facets that no tube sees. A search with the front
// changes no visible region.
namespace tubefoot {
namespace {

using namespace test;

/// A wall of two facets that extend far behind the apex, and small facets before and behind it.
Scene walled_scene(std::uint64_t seed, int small_facets) {
  Random random(seed);
  const auto number = [&](int lo, int hi) { return uniform(random, lo, hi); };
  Scene scene{"wall", {}, {}};
  FacetMesh& mesh = scene.mesh;
  const int lean = number(-3000, 3000);
  const VertexId a = add_vertex(mesh, {-90000, 10000 + lean, -90000}),
                 b = add_vertex(mesh, {90000, 10000 - lean, -90000}),
                 c = add_vertex(mesh, {90000, 10000 - lean, 90000}),
                 d = add_vertex(mesh, {-90000, 10000 + lean, 90000});
  add_facet(mesh, a, b, c);
  add_facet(mesh, a, c, d);
  for (int k = 0; k < small_facets; ++k) {
    const int y = k % 8 == 0 ? number(3000, 7000) : number(14000, 30000);
    const GridPoint at{number(-y / 3, y / 3), y, number(-y / 3, y / 3)};
    const auto beside = [&] {
      return add_vertex(mesh, {at.x + number(-150, 150), at.y + number(-150, 150), at.z + number(-150, 150)});
    };
    const VertexId p = beside(), q = beside(), r = beside();
    add_facet(mesh, p, q, r);
  }
  scene.tubes.reach = 1e9;
  append_tubes(scene.tubes, {{-0.3, -0.1, 0.1, 0.3},
                             {-0.25, 0.25},
                             glm::dmat3(glm::dvec3(0, 1, 0), glm::dvec3(1, 0, 0), glm::dvec3(0, 0, 1))});
  return scene;
}

struct BoxTally {
  std::size_t boxes = 0, hidden = 0;
};

/// Builds the front of the nearest facets and asks it for the boxes of all facets.
void check_boxes(const Scene& scene, BoxTally& tally) {
  const SceneTree tree(scene.mesh);
  VisibilityScratch scratch;
  TubeVisibility seen;
  for (std::uint32_t t = 0; t < scene.tubes.tubes.size(); ++t) {
    SCOPED_TRACE(testing::Message() << "tube " << t);
    VisibilityOptions options = with(Arithmetic::fixed);
    see(scene.mesh, tree, scene.tubes, t, options, scratch, seen);
    std::set<FacetId> visible;
    for (const NamedPiece& piece : seen.pieces) visible.insert(piece.facet);
    CandidateFacets candidates;
    const std::array<GridPoint, 4> rays = rays_of(scene.tubes, t);
    candidates.gather(scene.mesh, tree, scene.tubes.apex, scene.tubes.reach, rays, false);
    std::vector<RangedFacet> facets = candidates.facets();
    std::ranges::sort(facets, {}, &RangedFacet::nearest);
    for (const std::size_t share : {4, 2, 1}) {
      const std::vector<RangedFacet> near(
          facets.begin(), facets.begin() + static_cast<std::ptrdiff_t>(facets.size() / share));
      EdgeRings rings;
      rings.build(near);
      Front front;
      front.build(rays, near, rings);
      for (const RangedFacet& facet : facets) {
        GridPoint low = facet.cone.point[0], high = low;
        for (const GridPoint& p : facet.cone.point) {
          low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
          high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
        }
        const auto gap = [](double lo, double hi) { return lo > 0 ? lo : hi < 0 ? -hi : 0; };
        const double distance = std::hypot(gap(low.x, high.x), gap(low.y, high.y), gap(low.z, high.z));
        ++tally.boxes;
        if (!front.hides(low, high, distance)) continue;
        ++tally.hidden;
        EXPECT_FALSE(visible.contains(facet.cone.id)) << "facet " << facet.cone.id << " is visible";
      }
    }
  }
}

// Law L4.
TEST(Front, HidesOnlyWhatNoTubeSees) {
  BoxTally tally;
  for (std::uint64_t seed = 1; seed <= 24 / one_in; ++seed)
    for (const Scene& scene : all_scenes(seed)) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", " << scene.name);
      check_boxes(scene, tally);
    }
  EXPECT_GT(tally.hidden, 200u / one_in);
}

TEST(Front, OfAWallThatExtendsBehindTheApexHidesNearlyEverythingBehindIt) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    BoxTally tally;
    check_boxes(walled_scene(seed, 400), tally);
    EXPECT_GT(tally.hidden, tally.boxes / 2);
  }
}

TEST(Front, OmitsHiddenFacetsAndChangesNoRegion) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const Scene scene = walled_scene(seed, 20000);
    const SceneTree tree(scene.mesh);
    VisibilityScratch scratch;
    TubeVisibility all, front;
    VisibilityOptions options = with(Arithmetic::fixed);
    for (std::uint32_t t = 0; t < scene.tubes.tubes.size(); ++t) {
      options.open_water = true;
      see(scene.mesh, tree, scene.tubes, t, options, scratch, all);
      options.open_water = false;
      see(scene.mesh, tree, scene.tubes, t, options, scratch, front);
      EXPECT_LT(front.candidates, all.candidates / 2) << "tube " << t;
      EXPECT_EQ(audit(scene.mesh, scene.tubes, t, front, 1).hash,
                audit(scene.mesh, scene.tubes, t, all, 1).hash);
    }
  }
}

}  // namespace
}  // namespace tubefoot
