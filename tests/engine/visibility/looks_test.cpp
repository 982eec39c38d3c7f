// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that one query for two apexes gives the same visible polygons as separate queries, tube by tube, and
// the common visibility of both. Tubes that are traced together have the same regions.
#include "engine/visibility/looks.hpp"

#include <gtest/gtest.h>

#include <random>
#include <tuple>
#include <utility>
#include <vector>

#include "engine/visibility/bistatic_history.hpp"
#include "engine/visibility/tube_engine.hpp"
#include "fixtures/world/path_scenes.hpp"
#include "geometry/footprints/footprint_builder.hpp"

namespace tubefoot {
namespace {

using namespace test;

/// A seabed under loose facets that hide parts of it and of each other.
FacetMesh strewn(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> any(-1, 1);
  FacetMesh mesh = square_seabed(-6, 8);
  for (int k = 0; k < 12; ++k) {
    const glm::dvec3 middle(5 * any(random), 5 * any(random), -4 + any(random));
    const auto near = [&] { return middle + glm::dvec3(any(random), any(random), any(random)); };
    const glm::dvec3 a = near(), b = near(), c = near();
    add_triangle(mesh, a, b, c);
  }
  return mesh;
}

/// Traces each tube of a set alone and returns the footprints of all.
FootprintSet traced_one_by_one(const TubeEngine& engine, const TubeSet& tubes) {
  std::vector<FootprintSet> sets;
  for (std::uint32_t tube = 0; tube < tubes.tubes.size(); ++tube) {
    TubeSet alone = tubes;
    alone.tubes = {tubes.tubes[tube]};
    sets.push_back(engine.trace(std::move(alone)).footprints);
    for (Footprint& footprint : sets.back().footprints) footprint.tube = tube;
  }
  return joined(sets);
}

TEST(Looks, TellWhatEachApexTracesByItselfAndBothShare) {
  std::size_t occluders = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(seed);
    const FacetMesh mesh = strewn(seed);
    const SceneTree tree(mesh);
    const TubeSet ends[]{around({0, 0, 0}, -80, -10, 5, 40), around({1, -0.5, -0.25}, -80, -10, 5, 40)};
    std::vector<std::vector<TubeVisibility>> seen;
    for (const TubeSet& tubes : ends) {
      seen.push_back(look(mesh, tree, tubes, {}));
      const TubeEngine engine(mesh, tree, unit, {});
      const FootprintSet told = history_of(mesh, tubes, seen.back(), unit).footprints,
                         traced = traced_one_by_one(engine, tubes), together = engine.trace(tubes).footprints;
      EXPECT_EQ(told.corners_m, traced.corners_m);
      EXPECT_EQ(told.occluders, traced.occluders);
      EXPECT_EQ(told.occluders, together.occluders);
      occluders += told.occluders.size();
      ASSERT_EQ(told.footprints.size(), traced.footprints.size());
      ASSERT_EQ(told.footprints.size(), together.footprints.size());
      for (std::size_t k = 0; k < told.footprints.size(); ++k) {
        const Footprint &a = told.footprints[k], &b = traced.footprints[k];
        EXPECT_EQ(std::tie(a.facet, a.tube, a.piece_count, a.occluder_count),
                  std::tie(b.facet, b.tube, b.piece_count, b.occluder_count));
        EXPECT_EQ(std::tie(a.area_m2, a.solid_angle_sr, a.slant_range_min_m, a.slant_range_max_m),
                  std::tie(b.area_m2, b.solid_angle_sr, b.slant_range_min_m, b.slant_range_max_m));
        EXPECT_GT(a.area_m2, 0);
        const Footprint& c = together.footprints[k];
        EXPECT_EQ(std::tie(a.facet, a.tube, a.occluder_count), std::tie(c.facet, c.tube, c.occluder_count));
        EXPECT_NEAR(a.area_m2, c.area_m2, 1e-12 * a.area_m2);
      }
    }
    const FootprintSharer sharer(mesh, {ends[0], seen[0]}, {ends[1], seen[1]}, unit);
    const SharedFootprints told = shared_by_all(sharer), one_by_one = sharer.all(),
                           traced = trace_bistatic(mesh, tree, unit, {}, ends[0], ends[1]).shared;
    EXPECT_GT(told.pieces.size(), 0u);
    EXPECT_EQ(told.corners_m, one_by_one.corners_m);
    EXPECT_EQ(told.corners_m, traced.corners_m);
    EXPECT_EQ(told.receiver_m, traced.receiver_m);
    EXPECT_EQ(told.facets.size(), traced.facets.size());
  }
  EXPECT_GT(occluders, 50u);
}

}  // namespace
}  // namespace tubefoot
