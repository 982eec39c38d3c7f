// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/visibility/closure.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "fixtures/geometry/grid_scenes.hpp"
#include "fixtures/geometry/looks.hpp"

// Tests that the audit detects each manipulation of a result: missing, duplicate, moved and wrongly
// attributed pieces.
namespace tubefoot {
namespace {

using namespace test;

constexpr std::uint64_t label = 42;

struct Seen {
  FacetMesh mesh;
  TubeSet tubes;
  TubeVisibility visibility;
  TubeAudit check(const TubeVisibility& v) const { return audit(mesh, tubes, 0, v, label); }
};

Seen see_first_tube(FacetMesh mesh, TubeSet tubes) {
  Seen seen{std::move(mesh), std::move(tubes), {}};
  const SceneTree tree(seen.mesh);
  VisibilityScratch scratch;
  see(seen.mesh, tree, seen.tubes, 0, with(Arithmetic::fixed), scratch, seen.visibility);
  return seen;
}

/// Makes facets that are visible in several pieces each, and some open water.
Seen random_triangles(std::uint64_t seed) {
  Random random(seed);
  return see_first_tube(make_random_triangles(random, 9, 1000000, 500000),
                        forward_tubes({0, 0, 0}, 1, 1, 40, 40));
}

/// Returns up to six indices below `count`, evenly distributed, because an audit of manipulated pieces is
/// slow.
std::vector<std::size_t> some(std::size_t count) {
  std::vector<std::size_t> indices;
  for (std::size_t k = 0; k < count; k += count / 6 + 1) indices.push_back(k);
  return indices;
}

template <class Check>
void on_random_triangles(const Check& check) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const Seen seen = random_triangles(seed);
    const TubeAudit right = seen.check(seen.visibility);
    ASSERT_TRUE(right.closes);
    ASSERT_EQ(right.defect, 0);
    ASSERT_GT(right.pieces, 3u);
    ASSERT_FALSE(seen.visibility.open.empty());
    check(seen, right);
  }
}

// Law C1.
TEST(Closure, EmptySceneIsAllOpenWater) {
  const Seen seen = see_first_tube({}, forward_tubes({1, 2, 3}, 1, 1, 30, 20));
  const TubeAudit audit = seen.check(seen.visibility);
  EXPECT_TRUE(audit.closes);
  EXPECT_EQ(audit.facets, 0u);
  EXPECT_EQ(audit.pieces, 0u);
  EXPECT_EQ(audit.covered_fraction, 0);
  EXPECT_EQ(audit.hash, TopologyHash{});
  EXPECT_FALSE(seen.visibility.open.empty());
}

TEST(Closure, CoveredFractionIsThatOfTheGnomonicPlane) {
  FacetMesh whole, half;
  for (FacetMesh* mesh : {&whole, &half}) {
    const std::int32_t right = mesh == &whole ? 8 : 0;
    for (const GridPoint p : {GridPoint{-8, 8, -8}, {right, 8, -8}, {right, 8, 8}, {-8, 8, 8}})
      add_vertex(*mesh, p);
    add_facet(*mesh, 0, 1, 2);
    add_facet(*mesh, 0, 2, 3);
  }
  const TubeSet tubes = lattice_tubes({0, 0, 0}, -1, -1, 1, 1, 4);
  TubeSet centred = tubes;
  centred.rays = {{-1, 4, -1}, {1, 4, -1}, {-1, 4, 1}, {1, 4, 1}};
  for (const auto& [mesh, fraction] : {std::pair{whole, 1.0}, {half, 0.5}}) {
    const Seen seen = see_first_tube(mesh, centred);
    const TubeAudit audit = seen.check(seen.visibility);
    EXPECT_TRUE(audit.closes);
    EXPECT_DOUBLE_EQ(audit.covered_fraction, fraction);
    EXPECT_EQ(audit.facets, fraction == 1 ? 2u : 1u) << "the diagonal passes through the whole one only";
    EXPECT_EQ(seen.visibility.open.empty(), fraction == 1);
  }
}

// Laws C1 and C2.
TEST(Closure, AMissingPieceShows) {
  on_random_triangles([](const Seen& seen, const TubeAudit& right) {
    for (const std::size_t k : some(seen.visibility.pieces.size())) {
      TubeVisibility v = seen.visibility;
      v.pieces.erase(v.pieces.begin() + k);
      const TubeAudit wrong = seen.check(v);
      EXPECT_FALSE(wrong.closes);
      EXPECT_LT(wrong.defect, 0);
      EXPECT_NE(wrong.hash, right.hash);
      EXPECT_LT(wrong.covered_fraction, right.covered_fraction);
    }
    TubeVisibility v = seen.visibility;
    v.open.pop_back();
    EXPECT_FALSE(seen.check(v).closes);
    EXPECT_LT(seen.check(v).defect, 0);
  });
}

// Laws C1 and C2.
TEST(Closure, ADoubledPieceShows) {
  on_random_triangles([](const Seen& seen, const TubeAudit& right) {
    for (const std::size_t k : some(seen.visibility.pieces.size())) {
      TubeVisibility v = seen.visibility;
      v.pieces.insert(v.pieces.begin() + k, NamedPiece(v.pieces[k]));
      const TubeAudit wrong = seen.check(v);
      EXPECT_FALSE(wrong.closes);
      EXPECT_GT(wrong.defect, 0);
      EXPECT_NE(wrong.hash, right.hash);
    }
    TubeVisibility v = seen.visibility;
    v.open.push_back(v.open.front());
    EXPECT_FALSE(seen.check(v).closes);
  });
}

// Law C2.
TEST(Closure, APieceOfAnotherFacetShowsInTheHash) {
  on_random_triangles([](const Seen& seen, const TubeAudit& right) {
    for (const std::size_t k : some(seen.visibility.pieces.size())) {
      TubeVisibility v = seen.visibility;
      v.pieces[k].facet = (v.pieces[k].facet + 1) % static_cast<FacetId>(seen.mesh.facets.size());
      std::stable_sort(v.pieces.begin(), v.pieces.end(),
                       [](const NamedPiece& a, const NamedPiece& b) { return a.facet < b.facet; });
      EXPECT_TRUE(seen.check(v).closes) << "the areas are right";
      EXPECT_NE(seen.check(v).hash, right.hash) << "whose they are is not";
    }
  });
}

// Laws C1 and C2.
TEST(Closure, AMovedCornerShows) {
  on_random_triangles([](const Seen& seen, const TubeAudit& right) {
    const TubeVisibility& original = seen.visibility;
    for (const std::size_t k : some(original.pieces.size() - 1)) {
      const NamedPiece &piece = original.pieces[k], &other = original.pieces[k + 1];
      // A corner of the tube itself, a corner of the next piece.
      CornerName ray;
      ray.point = ray_bit | 2;
      for (const CornerName& name : {ray, original.corners[other.first]}) {
        TubeVisibility v = original;
        v.corners[piece.first] = name;
        const NameContext context{seen.mesh, seen.tubes.apex, v.rays};
        const ExactVector axis = gnomonic_axis(seen.tubes, 0);
        const bool same_area = gnomonic_area(axis, exact_directions(context, v.corners, piece)) ==
                               gnomonic_area(axis, exact_directions(context, original.corners, piece));
        EXPECT_EQ(seen.check(v).closes, same_area);
        EXPECT_EQ(seen.check(v).hash == right.hash, same_area);
      }
    }
  });
}

// Law C2.
TEST(Closure, HowAPieceIsCutUpDoesNotShow) {
  std::size_t cut = 0;
  on_random_triangles([&](const Seen& seen, const TubeAudit& right) {
    for (const std::size_t k : some(seen.visibility.pieces.size())) {
      TubeVisibility v = seen.visibility;
      const NamedPiece piece = v.pieces[k];
      if (piece.count < 4) continue;
      ++cut;
      v.corners.push_back(v.corners[piece.first]);
      for (std::uint32_t c = 2; c < piece.count; ++c)
        v.corners.push_back(CornerName(v.corners[piece.first + c]));
      const auto first_copy = static_cast<std::uint32_t>(seen.visibility.corners.size());
      v.pieces[k].count = 3;
      v.pieces.insert(v.pieces.begin() + k, NamedPiece{piece.facet, first_copy, piece.count - 1});
      EXPECT_TRUE(seen.check(v).closes);
      EXPECT_EQ(seen.check(v).hash, right.hash);
      EXPECT_EQ(seen.check(v).facets, right.facets);
      EXPECT_EQ(seen.check(v).pieces, right.pieces + 1);
    }
  });
  EXPECT_GT(cut, 5u);
}

TEST(Closure, HashTellsTubesFacetsAndDepthsApart) {
  on_random_triangles([](const Seen& seen, const TubeAudit& right) {
    EXPECT_NE(audit(seen.mesh, seen.tubes, 0, seen.visibility, label + 1).hash, right.hash);
    EXPECT_EQ(audit(seen.mesh, seen.tubes, 0, seen.visibility, label).hash, right.hash);
    // Twice as far and twice as large: the same areas for other facets.
    FacetMesh far = seen.mesh;
    for (GridPoint& p : far.vertices) p = {2 * p.x, 2 * p.y, 2 * p.z};
    const Seen doubled = see_first_tube(far, seen.tubes);
    EXPECT_TRUE(doubled.check(doubled.visibility).closes);
    EXPECT_NE(doubled.check(doubled.visibility).hash, right.hash);
    EXPECT_DOUBLE_EQ(doubled.check(doubled.visibility).covered_fraction, right.covered_fraction);
  });
}

// Law C2.
TEST(Closure, HashesAddUpInAnyOrder) {
  std::vector<TopologyHash> hashes;
  std::set<std::string> distinct;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Seen seen = random_triangles(seed);
    hashes.push_back(seen.check(seen.visibility).hash);
    distinct.insert(hashes.back().hex());
    EXPECT_EQ(hashes.back().hex().size(), 32u);
  }
  EXPECT_EQ(distinct.size(), hashes.size());
  TopologyHash forwards, backwards;
  for (const TopologyHash& h : hashes) forwards += h;
  std::reverse(hashes.begin(), hashes.end());
  for (const TopologyHash& h : hashes) backwards += h;
  EXPECT_EQ(forwards, backwards);
}

TEST(Closure, AnInexactResultIsReportedNotThrown) {
  // Rounding may leave corners where there is no point, even beyond the horizon of the gnomonic plane. The
  // audit does not close then.
  for (std::uint64_t seed = 1; seed <= 16 / one_in; ++seed)
    for (const Scene& scene : adversarial_cases(seed)) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", " << scene.name);
      EXPECT_NO_THROW(look(scene.mesh, scene.tubes, with(Arithmetic::plain_double)));
    }
}

}  // namespace
}  // namespace tubefoot
