// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/search/height_fields.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "fixtures/geometry/grid_scenes.hpp"
#include "geometry/visibility/closure.hpp"

// Tests height fields, which are surfaces that each vertical line meets at most once. The visible polygons
// of a tube do not depend on the search for height fields. The proof must reject surfaces that a vertical
// line meets twice.
namespace tubefoot {
namespace {

using namespace test;

constexpr std::int32_t width = 1 << 20, depth = 1 << 18;

FacetMesh terrain(Random& random, int n = 8) {
  return rough_terrain(random, n, width, -depth, width / (2 * n));
}

void remove_facets(FacetMesh& mesh, Random& random, int one_of) {
  std::erase_if(mesh.facets, [&](const auto&) { return uniform(random, 1, one_of) == 1; });
  mesh.material.resize(mesh.facets.size());
  mesh.component.resize(mesh.facets.size());
}

void turn_over(FacetMesh& mesh) {
  for (auto& facet : mesh.facets) std::swap(facet[1], facet[2]);
}

struct Seen {
  TopologyHash hash;
  std::size_t candidates = 0, not_closed = 0;
};

Seen see_all(const FacetMesh& mesh, const TubeSet& tubes, SceneTree::HeightFieldSearch height_fields) {
  const SceneTree tree(mesh, height_fields);
  VisibilityScratch scratch;
  TubeVisibility seen;
  VisibilityOptions options;
  options.open_water = true;
  Seen all;
  for (std::uint32_t t = 0; t < tubes.tubes.size(); ++t) {
    see(mesh, tree, tubes, t, options, scratch, seen);
    const TubeAudit tube = audit(mesh, tubes, t, seen, t);
    all.hash += tube.hash;
    all.not_closed += !tube.closes;
    all.candidates += seen.candidates;
  }
  return all;
}

/// Returns the number of candidate facets with height fields. The test fails if any other result differs.
std::size_t expect_same(const FacetMesh& mesh, const TubeSet& tubes, std::size_t& all) {
  const Seen with = see_all(mesh, tubes, SceneTree::HeightFieldSearch::proven),
             without = see_all(mesh, tubes, SceneTree::HeightFieldSearch::ignored);
  EXPECT_EQ(with.hash, without.hash);
  EXPECT_EQ(with.not_closed, 0u);
  EXPECT_EQ(without.not_closed, 0u);
  all = without.candidates;
  return with.candidates;
}

TEST(HeightFields, ATerrainIsOneHeightFieldEitherWayUp) {
  Random random(1);
  FacetMesh mesh = terrain(random);
  for (int way = 0; way < 2; ++way, turn_over(mesh)) {
    const HeightFields height_fields(mesh);
    ASSERT_EQ(height_fields.count(), 1u);
    for (FacetId f = 0; f < mesh.facets.size(); ++f) EXPECT_EQ(height_fields.height_field_of(f), 0);
  }
}

TEST(HeightFields, PartsOneAboveTheOtherAreHeightFieldsOfTheirOwn) {
  Random random(2);
  FacetMesh mesh = terrain(random);
  const auto vertices = static_cast<VertexId>(mesh.vertices.size());
  const std::size_t facets = mesh.facets.size();
  for (VertexId v = 0; v < vertices; ++v) {
    GridPoint p = mesh.vertices[v];
    p.z -= 2 * depth;
    add_vertex(mesh, p);
  }
  for (std::size_t f = 0; f < facets; ++f) {
    const auto v = mesh.facets[f];
    add_facet(mesh, v[0] + vertices, v[1] + vertices, v[2] + vertices);
  }
  const HeightFields height_fields(mesh);
  EXPECT_EQ(height_fields.count(), 2u);
  EXPECT_NE(height_fields.height_field_of(0), height_fields.height_field_of(static_cast<FacetId>(facets)));
}

TEST(HeightFields, HolesAndRaggedBordersAreFine) {
  std::size_t proven = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    FacetMesh mesh = terrain(random, 12);
    remove_facets(mesh, random, 12);
    const HeightFields height_fields(mesh);
    // Parts that holes cut off are also height fields, if they are large enough.
    EXPECT_GE(height_fields.count(), 1u) << "seed " << seed;
    proven += height_fields.count();
  }
  EXPECT_GE(proven, 20u);
}

/// A ramp of `turns` turns about the vertical axis. Each facet faces up, and each inner edge has two
/// facets.
FacetMesh ramp(double turns, std::int32_t rise) {
  FacetMesh mesh;
  const int steps = static_cast<int>(24 * turns);
  for (int k = 0; k <= steps; ++k) {
    const double angle = 2 * std::acos(-1.0) * k / 24;
    for (const double radius : {1e5, 3e5})
      add_vertex(mesh, {static_cast<std::int32_t>(std::lround(radius * std::cos(angle))),
                        static_cast<std::int32_t>(std::lround(radius * std::sin(angle))), rise * k});
  }
  for (int k = 0; k < steps; ++k) {
    const auto a = static_cast<VertexId>(2 * k);
    add_facet(mesh, a, a + 1, a + 3);
    add_facet(mesh, a, a + 3, a + 2);
  }
  return mesh;
}

TEST(HeightFields, ARampIsAHeightFieldUntilItPassesOverItself) {
  EXPECT_EQ(HeightFields(ramp(0.9, 1000)).count(), 1u);
  EXPECT_EQ(HeightFields(ramp(1.25, 1000)).count(), 0u);
}

// Law H1.
TEST(HeightFields, ATipThatPokesOverAnotherBorderIsFound) {
  FacetMesh mesh = ramp(0.9, 1000);
  GridPoint& tip = mesh.vertices.back();
  tip.x = 290000;  // past the start of the ramp, but all midpoints of border edges stay clear of it
  tip.y = 10000;
  EXPECT_EQ(HeightFields(mesh).count(), 0u);
  tip.y = -10000;
  EXPECT_EQ(HeightFields(mesh).count(), 1u);
}

/// A large seabed with a small one above it, joined crosswise along a slit of two edges. A path across the
/// slit leads from one to the other. All facets face up, each inner edge has two facets, and no border
/// edges intersect. Only their winding number reveals that the middle is covered twice.
FacetMesh two_storeys(std::int32_t unit) {
  FacetMesh mesh;
  std::map<std::array<int, 3>, VertexId> ids;  // column, row, storey
  const auto vertex = [&](int i, int j, int storey) {
    if (j == 6 && (i == 5 || i == 7)) storey = 0;  // the ends of the slit
    const auto [entry, is_new] = ids.try_emplace({i, j, storey}, static_cast<VertexId>(mesh.vertices.size()));
    if (is_new) add_vertex(mesh, {i * unit, j * unit, storey * unit});
    return entry->second;
  };
  for (int storey = 0; storey < 2; ++storey)
    for (int j = storey ? 3 : 0; j < (storey ? 9 : 12); ++j)
      for (int i = storey ? 3 : 0; i < (storey ? 9 : 12); ++i) {
        const auto corner = [&](int x, int y) {
          const bool middle = x == 6 && y == 6;
          return vertex(x, y, middle && j >= 6 ? 1 - storey : storey);
        };
        add_facet(mesh, corner(i, j), corner(i + 1, j), corner(i + 1, j + 1));
        add_facet(mesh, corner(i, j), corner(i + 1, j + 1), corner(i, j + 1));
      }
  return mesh;
}

// Law H1.
TEST(HeightFields, TwoStoreysJoinedAtASlitAreNone) { EXPECT_EQ(HeightFields(two_storeys(1000)).count(), 0u); }

// Law H1.
TEST(HeightFields, AnOverhangIsCutOutOfItsHeightField) {
  Random random(3);
  FacetMesh mesh = terrain(random, 12);
  mesh.vertices[6 * 13 + 6].x += width / 4;  // pulled over its neighbours
  const HeightFields height_fields(mesh);
  // Some facets about the vertex have the opposite orientation and overlap the others. The rest must not
  // count as a height field if a vertical line meets it twice. Brute force in plan view decides.
  for (int trial = 0; trial < 2000; ++trial) {
    const GridPoint p{uniform(random, -width / 2, width / 2), uniform(random, 0, width), 0};
    std::map<std::uint16_t, int> hits;
    for (FacetId f = 0; f < mesh.facets.size(); ++f) {
      int turns = 0;
      for (int k = 0; k < 3; ++k) {
        const GridPoint a = mesh.vertices[mesh.facets[f][k]], b = mesh.vertices[mesh.facets[f][(k + 1) % 3]];
        const std::int64_t s = (std::int64_t(b.x) - a.x) * (std::int64_t(p.y) - a.y) -
                               (std::int64_t(b.y) - a.y) * (std::int64_t(p.x) - a.x);
        turns += (s > 0) - (s < 0);
      }
      if (std::abs(turns) == 3) ++hits[height_fields.height_field_of(f)];
    }
    hits.erase(HeightFields::none);
    for (const auto& [height_field, count] : hits) ASSERT_EQ(count, 1) << "sheet " << height_field;
  }
}

// Law H2.
TEST(HeightFields, ChangeNothingThatIsSeen) {
  std::size_t left = 0, all = 0;
  for (std::uint64_t seed = 1; seed <= 60 / one_in; ++seed) {
    Random random(seed);
    FacetMesh mesh = terrain(random, 8);
    if (seed % 3 == 1) remove_facets(mesh, random, 10);
    if (seed % 2 == 0) turn_over(mesh);
    if (seed % 5 == 0) add_box(mesh, {0, width / 2, -depth}, width / 8);
    for (int place = 0; place < 7; ++place) {
      const std::int32_t x = uniform(random, -width / 2, width / 2), y = uniform(random, 0, width);
      const GridPoint vertex = mesh.vertices[std::size_t(uniform(random, 0, 80))];
      const std::array<GridPoint, 7> apexes{{
          {x, -width / 8, 0},                   // above, before it
          {x, -width / 8, -depth - width / 8},  // below its border, before it
          {x, y, width / 16},                   // above it
          {x, y, -2 * depth},                   // below it
          {x, y, -depth},                       // within its relief
          vertex,                               // on it
          {vertex.x, vertex.y, vertex.z + 1},   // barely above it
      }};
      const TubeSet tubes = forward_tubes(apexes[place], 2, 2, 70, 70, uniform(random, -40, 40));
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", place " << place);
      std::size_t without = 0;
      left += expect_same(mesh, tubes, without);
      all += without;
      if (HasFailure()) return;
    }
  }
  EXPECT_LT(left, all);  // otherwise nothing was tested
}

TEST(HeightFields, FacetsThatFaceAwayAreLeftOutWhereTheTubeLooksDownOnThem) {
  Random random(4);
  const FacetMesh mesh = terrain(random, 16);
  const TubeSet tubes = forward_tubes({0, -width / 8, 0}, 1, 1, 30, 20, 16);
  std::size_t all = 0;
  const std::size_t left = expect_same(mesh, tubes, all);
  EXPECT_LT(static_cast<double>(left), 0.8 * static_cast<double>(all));
}

TEST(HeightFields, NothingIsLeftOutOfAViewFromBelow) {
  Random random(5);
  const FacetMesh mesh = terrain(random, 16);
  const TubeSet tubes = forward_tubes({0, -width / 8, -2 * depth}, 1, 1, 30, 20, -16);
  std::size_t all = 0;
  EXPECT_EQ(expect_same(mesh, tubes, all), all);
  EXPECT_GT(all, 50u);
}

TEST(HeightFields, AHoleInViewLetsItsUndersideBeSeen) {
  Random random(6);
  FacetMesh mesh = terrain(random, 16);
  FacetMesh holed = mesh;
  holed.facets.erase(holed.facets.begin() + 2 * (16 * 5 + 8), holed.facets.begin() + 2 * (16 * 5 + 8) + 2);
  holed.material.pop_back();
  holed.component.pop_back();
  ASSERT_EQ(HeightFields(holed).count(), 1u);
  const TubeSet at_it = forward_tubes({0, -width / 8, 0}, 1, 1, 30, 20, 25);
  std::size_t all = 0;
  EXPECT_EQ(expect_same(holed, at_it, all), all);
  TubeSet beside = forward_tubes({-width / 3, -width / 8, 0}, 1, 1, 10, 20, 25);
  EXPECT_LT(expect_same(holed, beside, all), all);
}

// Otherwise the result for a part of a terrain in memory would differ from that for the whole.
TEST(HeightFields, AHoleBeyondTheReachChangesNothing) {
  Random random(6);
  const FacetMesh mesh = terrain(random, 16);
  FacetMesh holed = mesh;
  holed.facets.erase(holed.facets.begin() + 2 * (16 * 14 + 8), holed.facets.begin() + 2 * (16 * 14 + 8) + 2);
  holed.material.pop_back();
  holed.component.pop_back();
  TubeSet tubes = forward_tubes({0, -3 * (width / 8), 0}, 1, 1, 30, 20, 20);
  std::size_t all = 0;
  EXPECT_EQ(expect_same(holed, tubes, all), all) << "within it, it is in view";
  // the seabed is in view from half a width on, and the hole is four fifths away
  tubes.reach = 0.7 * width;
  const std::size_t left = expect_same(mesh, tubes, all);
  EXPECT_LT(left, all);
  EXPECT_EQ(expect_same(holed, tubes, all), left);
}

TEST(HeightFields, FewFacetsAndVerticalOnesAreNone) {
  FacetMesh mesh;
  add_plate(mesh, 1000, 8, 100, false);
  EXPECT_EQ(HeightFields(mesh).count(), 0u);
  FacetMesh box;
  add_box(box, {0, 0, 0}, 100);
  EXPECT_EQ(HeightFields(box).count(), 0u);
  EXPECT_EQ(HeightFields(FacetMesh{}).count(), 0u);
}

}  // namespace
}  // namespace tubefoot
