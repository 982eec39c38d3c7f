// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>

#include "fixtures/geometry/layered_scenes.hpp"
#include "fixtures/geometry/looks.hpp"

// Tests that tubes of a run have the same visible regions as single tubes.
namespace tubefoot {
namespace {

using namespace test;

/// The visible facets of which a part is hidden.
std::vector<FacetId> hidden_in_part(const TubeVisibility& seen) {
  std::vector<FacetId> facets;
  for (const auto& [facet, occluder] : seen.occluders)
    if ((facets.empty() || facets.back() != facet) &&
        std::ranges::binary_search(seen.pieces, facet, {}, &NamedPiece::facet))
      facets.push_back(facet);
  return facets;
}

void expect_same(const FacetMesh& mesh, const TubeSet& tubes, std::uint32_t tube,
                 const TubeVisibility& together, const TubeVisibility& alone) {
  const TubeAudit audited = audit(mesh, tubes, tube, together, 1);
  EXPECT_TRUE(audited.closes);
  EXPECT_EQ(audited.hash, audit(mesh, tubes, tube, alone, 1).hash);
  EXPECT_TRUE(std::equal(together.rays.begin(), together.rays.begin() + 4, alone.rays.begin()));
  EXPECT_TRUE(std::ranges::is_sorted(together.pieces, {}, &NamedPiece::facet));
  EXPECT_TRUE(std::ranges::is_sorted(together.occluders));
  EXPECT_EQ(std::ranges::adjacent_find(together.occluders), together.occluders.end());
  EXPECT_EQ(hidden_in_part(together), hidden_in_part(alone));
}

/// Whether the first point of each plane's name precedes the second. Their order defines the plane's normal.
bool is_ordered(const CornerName& name) {
  const auto ordered = [](const PlaneName& plane) { return plane.depth || plane.a < plane.b; };
  return name.point != no_point || (ordered(name.p) && ordered(name.q));
}

/// A sector straight ahead (+y) and slightly downwards, in columns and rows of tubes.
TubeSet sector(GridPoint apex, double reach, Random& random, int columns, int rows) {
  AngularGrid grid;
  const double half_width = uniform(random, 50, 900) / 1000.0,
               half_height = uniform(random, 50, 500) / 1000.0;
  for (int k = 0; k <= columns; ++k) grid.azimuth_edges_rad.push_back(half_width * (2.0 * k / columns - 1));
  for (int k = 0; k <= rows; ++k) grid.elevation_edges_rad.push_back(half_height * (2.0 * k / rows - 1));
  const double tilt = uniform(random, -100, 500) / 1000.0, c = std::cos(tilt), s = std::sin(tilt);
  grid.frame = glm::dmat3(glm::dvec3(0, c, -s), glm::dvec3(1, 0, 0), glm::dvec3(0, s, c));
  TubeSet tubes;
  tubes.apex = apex;
  tubes.reach = reach;
  append_tubes(tubes, grid);
  return tubes;
}

struct Compared {
  std::size_t tubes = 0, pieces = 0, occluders = 0;
};

/// Compares the tubes of `run` together with each tube alone.
void compare(const FacetMesh& mesh, const SceneTree& tree, const TubeSet& tubes, TubeRun run,
             const VisibilityOptions& options, Compared& compared) {
  VisibilityScratch together_scratch, alone_scratch;
  TubeVisibility together, alone;
  std::uint32_t next = run.first;
  see_run(mesh, tree, tubes, run, options, together_scratch, together, [&](std::uint32_t tube) {
    EXPECT_EQ(tube, next++) << "in turn";
    see(mesh, tree, tubes, tube, options, alone_scratch, alone);
    SCOPED_TRACE(testing::Message() << "tube " << tube << " of " << run.first << " to " << run.end);
    expect_same(mesh, tubes, tube, together, alone);
    EXPECT_TRUE(std::ranges::all_of(together.corners, is_ordered));
    ++compared.tubes;
    compared.pieces += alone.pieces.size();
    compared.occluders += alone.occluders.size();
  });
  EXPECT_EQ(next, run.end);
}

// Law V12.
TEST(TubeRuns, SeeWhatEachTubeSeesAlone) {
  Compared compared;
  for (std::uint64_t seed = 1; seed <= 24 / one_in; ++seed) {
    Random random(seed);
    for (const Scene& scene : all_scenes(seed)) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", " << scene.name);
      const SceneTree tree(scene.mesh);
      const VisibilityOptions options =
          with(seed % 4 == 0 ? Arithmetic::filtered : Arithmetic::fixed, seed % 2 == 0 ? 4 : 24);
      const TubeSet fan = sector(scene.tubes.apex, scene.tubes.reach, random, 16, 1),
                    grid = sector(scene.tubes.apex, scene.tubes.reach, random, 3, 5);
      for (const TubeSet* tubes : {&scene.tubes, &fan, &grid}) {
        for (const TubeRun run : runs_of(*tubes)) compare(scene.mesh, tree, *tubes, run, options, compared);
        // Any tubes may run together, not only adjacent ones.
        const auto last = static_cast<std::int32_t>(tubes->tubes.size()) - 1;
        const auto first = static_cast<std::uint32_t>(uniform(random, 0, last));
        const auto end =
            static_cast<std::uint32_t>(uniform(random, static_cast<std::int32_t>(first), last)) + 1;
        compare(scene.mesh, tree, *tubes, {first, end}, options, compared);
      }
    }
  }
  EXPECT_GT(compared.tubes, 5000u / one_in);
  EXPECT_GT(compared.pieces, 100000u / one_in);
  EXPECT_GT(compared.occluders, 20000u / one_in);
}

TEST(TubeRuns, AreAllTubesInOrderAndSplitWhereTubesDoNotShareAWall) {
  Random random(7);
  TubeSet tubes = sector({0, 0, 0}, 1e9, random, 4, 3);
  append_tubes(tubes, AngularGrid{{0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1}, {-0.1, 0.1}});
  const std::vector<TubeRun> runs = runs_of(tubes);
  std::uint32_t next = 0;
  for (const TubeRun& run : runs) {
    EXPECT_EQ(run.first, next);
    ASSERT_LT(run.first, run.end);
    next = run.end;
  }
  EXPECT_EQ(next, tubes.tubes.size());
  // Columns of three with each tube above the previous one, then a fan without a common wall.
  ASSERT_GE(runs.size(), 6u);
  for (std::uint32_t k = 0; k <= 4; ++k) EXPECT_EQ(runs[k].first, 3 * k);
  EXPECT_LT(runs.size(), 4u + 11u) << "neighbours run together";
  EXPECT_TRUE(runs_of(TubeSet{}).empty());
}

/// Beams of `width` radians in steps of 0.02 rad, each with its own rays.
TubeSet beams(double width, int count) {
  TubeSet tubes;
  tubes.reach = 1e9;
  for (int k = 0; k < count; ++k)
    append_tubes(tubes, AngularGrid{{0.02 * k - width / 2, 0.02 * k + width / 2}, {-0.1, 0.1}});
  return tubes;
}

TEST(TubeRuns, HaveOverlappingTubesTogether) {
  EXPECT_EQ(runs_of(beams(0.06, 16)).size(), 2u);
  EXPECT_EQ(runs_of(beams(0.01, 16)).size(), 16u) << "the beams have gaps between them";
}

// Law V12.
TEST(TubeRuns, OfOverlappingTubesSeeWhatEachTubeSeesAlone) {
  Compared compared;
  for (std::uint64_t seed = 1; seed <= 6; ++seed)
    for (const Scene& scene : all_scenes(seed)) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", " << scene.name);
      const SceneTree tree(scene.mesh);
      TubeSet tubes = beams(0.07, 24);
      tubes.apex = scene.tubes.apex;
      for (const TubeRun run : runs_of(tubes))
        compare(scene.mesh, tree, tubes, run, with(Arithmetic::fixed), compared);
    }
  EXPECT_GT(compared.pieces, 500u);
}

}  // namespace
}  // namespace tubefoot
