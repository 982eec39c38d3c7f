// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <set>

#include "fixtures/geometry/layered_scenes.hpp"
#include "fixtures/geometry/looks.hpp"

// Tests laws of visible polygons that hold in each scene, for any algorithm. All are equalities of
// rationals.
namespace tubefoot {
namespace {

using namespace test;

/// Runs `check(scene, random)` on scenes of all kinds, and every fourth time also on the large layered
/// ones. Stops at the first failure.
template <class Check>
void on_all_scenes(std::uint64_t first_seed, std::uint64_t seeds, const Check& check) {
  for (std::uint64_t seed = first_seed; seed < first_seed + std::max<std::uint64_t>(4, seeds / one_in);
       ++seed)
    for (const Scene& scene : seed % 4 == 0 ? all_scenes(seed) : adversarial_cases(seed)) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", " << scene.name);
      Random random(seed);
      check(scene, random);
      if (testing::Test::HasFailure()) return;
    }
}

FacetMesh mapped(FacetMesh mesh, const auto& map) {
  for (GridPoint& p : mesh.vertices) p = map(p);
  return mesh;
}

GridPoint sum(GridPoint a, GridPoint b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }

/// Returns whether another facet lies in the plane of facet f. They may overlap, so that only one is
/// visible.
bool shares_plane(const FacetMesh& mesh, FacetId f, GridPoint apex) {
  FacetCone cone, other;
  if (!FacetCone::make(mesh, f, apex, cone)) return true;
  for (FacetId g = 0; g < mesh.facets.size(); ++g) {
    if (g == f || !FacetCone::make(mesh, g, apex, other)) continue;
    bool in_plane = true;
    for (const GridPoint& p : other.point) in_plane = in_plane && dot(cone.normal, p) == cone.offset;
    if (in_plane) return true;
  }
  return false;
}

// Laws C1 and V2.
TEST(VisibilityLaws, ExactArithmeticsCloseAndAgree) {
  std::size_t tubes = 0;
  on_all_scenes(1, 16, [&](const Scene& scene, Random&) {
    const Look fixed = look(scene.mesh, scene.tubes, with(Arithmetic::fixed));
    const Look filtered = look(scene.mesh, scene.tubes, with(Arithmetic::filtered));
    const Look rational = look(scene.mesh, scene.tubes, with(Arithmetic::rational));
    EXPECT_EQ(fixed.not_closed, 0u);
    EXPECT_EQ(filtered.not_closed, 0u);
    EXPECT_EQ(rational.not_closed, 0u);
    EXPECT_EQ(fixed.hash.hex(), filtered.hash.hex());
    EXPECT_EQ(fixed.hash.hex(), rational.hash.hex());
    tubes += 3 * scene.tubes.tubes.size();
  });
  EXPECT_GT(tubes, 3000 / one_in);
}

// Law V8.
TEST(VisibilityLaws, SplittingATubeInternallyChangesNothing) {
  std::size_t finer = 0;
  on_all_scenes(101, 12, [&](const Scene& scene, Random&) {
    const Look whole = look(scene.mesh, scene.tubes, with(Arithmetic::fixed, 1000000));
    EXPECT_EQ(whole.not_closed, 0u);
    for (const std::uint32_t facets_per_split : {1u, 4u, 24u}) {
      const Look split = look(scene.mesh, scene.tubes, with(Arithmetic::fixed, facets_per_split));
      EXPECT_EQ(split.not_closed, 0u) << facets_per_split;
      EXPECT_EQ(split.hash.hex(), whole.hash.hex()) << facets_per_split;
      finer += split.pieces > whole.pieces;
    }
  });
  EXPECT_GT(finer, 100 / one_in) << "hardly a tube was split: the test says little";
}

// Law V3.
TEST(VisibilityLaws, OrderAndNamesChangeNothing) {
  on_all_scenes(201, 16, [&](const Scene& scene, Random& random) {
    const std::string expected = look(scene.mesh, scene.tubes).hash.hex();
    FacetMesh mesh = scene.mesh;
    std::shuffle(mesh.facets.begin(), mesh.facets.end(), random);
    EXPECT_EQ(look(mesh, scene.tubes).hash.hex(), expected) << "order of facets";

    for (auto& v : mesh.facets) std::shuffle(v.begin(), v.end(), random);
    EXPECT_EQ(look(mesh, scene.tubes).hash.hex(), expected) << "order of a facet's vertices";

    std::vector<VertexId> place(mesh.vertices.size());
    std::iota(place.begin(), place.end(), 0u);
    std::shuffle(place.begin(), place.end(), random);
    FacetMesh renamed = mesh;
    for (VertexId v = 0; v < place.size(); ++v) renamed.vertices[place[v]] = mesh.vertices[v];
    for (auto& facet : renamed.facets)
      for (VertexId& v : facet) v = place[v];
    EXPECT_EQ(look(renamed, scene.tubes).hash.hex(), expected) << "order of vertices";

    FacetMesh apart;
    for (const auto& v : mesh.facets)
      add_facet(apart, add_vertex(apart, mesh.vertices[v[0]]), add_vertex(apart, mesh.vertices[v[1]]),
                add_vertex(apart, mesh.vertices[v[2]]));
    const Look unwelded = look(apart, scene.tubes);
    EXPECT_EQ(unwelded.not_closed, 0u);
    EXPECT_EQ(unwelded.hash.hex(), expected) << "no vertex shared";
  });
}

// Law V4.
TEST(VisibilityLaws, TranslationChangesNothing) {
  on_all_scenes(301, 16, [&](const Scene& scene, Random& random) {
    const GridPoint by{uniform(random, -(1 << 29), 1 << 29), uniform(random, -(1 << 29), 1 << 29),
                       uniform(random, -(1 << 29), 1 << 29)};
    TubeSet tubes = scene.tubes;
    tubes.apex = sum(tubes.apex, by);
    EXPECT_EQ(look(mapped(scene.mesh, [&](GridPoint p) { return sum(p, by); }), tubes).hash.hex(),
              look(scene.mesh, scene.tubes).hash.hex());
  });
}

// Law V5.
TEST(VisibilityLaws, ScalingAboutTheApexAndTurningTheAxesKeepAreas) {
  on_all_scenes(401, 16, [&](const Scene& scene, Random& random) {
    const auto expected = areas_of(scene.mesh, scene.tubes);
    TubeSet tubes = scene.tubes;
    tubes.apex = {0, 0, 0};
    std::int32_t reach = 1;
    for (const GridPoint& p : scene.mesh.vertices) {
      const GridPoint d = p - scene.tubes.apex;
      reach = std::max({reach, std::abs(d.x), std::abs(d.y), std::abs(d.z)});
    }
    const std::int32_t factor = uniform(random, 1, (1 << 30) / reach);
    const auto from_apex = [&](GridPoint p) { return p - scene.tubes.apex; };
    EXPECT_EQ(areas_of(mapped(scene.mesh,
                              [&](GridPoint p) {
                                const GridPoint d = from_apex(p);
                                return GridPoint{factor * d.x, factor * d.y, factor * d.z};
                              }),
                       tubes),
              expected)
        << "times " << factor;

    // The coordinates decide which of two coplanar facets is visible, so that the test compares their sum.
    const auto turn = [](GridPoint p) { return GridPoint{p.y, p.z, p.x}; };
    for (GridPoint& ray : tubes.rays) ray = turn(ray);
    const auto turned = areas_of(mapped(scene.mesh, [&](GridPoint p) { return turn(from_apex(p)); }), tubes);
    for (std::size_t t = 0; t < expected.size(); ++t) {
      CGAL::Exact_rational rest = 0;
      for (const auto& [facet, area] : expected[t]) {
        if (!shares_plane(scene.mesh, facet, scene.tubes.apex)) {
          EXPECT_EQ(turned[t].contains(facet) ? turned[t].at(facet) : 0, area) << "facet " << facet;
        }
        rest += area;
      }
      for (const auto& [facet, area] : turned[t]) rest -= area;
      EXPECT_EQ(rest, 0) << "tube " << t;
    }
  });
}

// Law V7.
TEST(VisibilityLaws, SplittingAFacetChangesNothing) {
  std::size_t split = 0;
  on_all_scenes(501, 14, [&](const Scene& scene, Random& random) {
    // Midpoints must be grid points.
    FacetMesh mesh = mapped(scene.mesh, [](GridPoint p) {
      const auto even = [](std::int32_t x) { return std::abs(x) < (1 << 20) ? 2 * x : x / 2 * 2; };
      return GridPoint{even(p.x), even(p.y), even(p.z)};
    });
    const auto before = areas_of(mesh, scene.tubes);
    std::set<FacetId> seen;
    for (const Areas& areas : before)
      for (const auto& [facet, area] : areas)
        if (!shares_plane(mesh, facet, scene.tubes.apex)) seen.insert(facet);
    if (seen.empty()) return;
    auto pick = seen.begin();
    std::advance(pick, uniform(random, 0, static_cast<int>(seen.size()) - 1));
    const FacetId facet = *pick;
    ++split;

    const auto v = mesh.facets[facet];
    const auto middle = [&](VertexId a, VertexId b) {
      const GridPoint p = mesh.vertices[a], q = mesh.vertices[b];
      return add_vertex(mesh, {static_cast<std::int32_t>((std::int64_t(p.x) + q.x) / 2),
                               static_cast<std::int32_t>((std::int64_t(p.y) + q.y) / 2),
                               static_cast<std::int32_t>((std::int64_t(p.z) + q.z) / 2)});
    };
    const auto first_new = static_cast<FacetId>(mesh.facets.size());
    const VertexId ab = middle(v[0], v[1]);
    if (uniform(random, 0, 1) == 0) {
      mesh.facets[facet] = {v[0], ab, v[2]};
      add_facet(mesh, ab, v[1], v[2]);
    } else {
      const VertexId bc = middle(v[1], v[2]), ca = middle(v[2], v[0]);
      mesh.facets[facet] = {ab, bc, ca};
      add_facet(mesh, v[0], ab, ca);
      add_facet(mesh, ab, v[1], bc);
      add_facet(mesh, ca, bc, v[2]);
    }
    auto after = areas_of(mesh, scene.tubes);
    for (std::size_t t = 0; t < after.size(); ++t) {
      CGAL::Exact_rational parts = 0;
      for (auto it = after[t].lower_bound(first_new); it != after[t].end(); it = after[t].erase(it))
        parts += it->second;
      if (parts != 0) after[t][facet] += parts;
      EXPECT_EQ(after[t], before[t]) << "tube " << t << ", facet " << facet;
    }
  });
  EXPECT_GT(split, 80 / one_in);
}

// Law V6.
TEST(VisibilityLaws, TubesAddUp) {
  std::size_t compared = 0;
  on_all_scenes(601, 12, [&](const Scene& scene, Random& random) {
    // Rays on a lattice: 6 x 6 fine tubes, and the same sector in 9, in 6 strips, and in one tube.
    TubeSet tubes = lattice_tubes(scene.tubes.apex, -3, -3, 6, 6, uniform(random, 2, 6));
    const auto corner = [](int i, int j) { return static_cast<std::uint32_t>(j * 7 + i); };
    const auto sum_of = [&](int width, int height) {
      tubes.tubes.clear();
      for (int i = 0; i < 6; i += width)
        for (int j = 0; j < 6; j += height)
          tubes.tubes.push_back(
              {corner(i, j), corner(i, j + height), corner(i + width, j + height), corner(i + width, j)});
      const SceneTree tree(scene.mesh);
      VisibilityScratch scratch;
      Areas areas;
      for (std::uint32_t t = 0; t < tubes.tubes.size(); ++t)
        add_areas(areas, scene.mesh, tree, tubes, t, ExactVector{0, 1, 0}, scratch);
      return areas;
    };
    const Areas whole = sum_of(6, 6);
    EXPECT_EQ(sum_of(1, 1), whole);
    EXPECT_EQ(sum_of(2, 2), whole);
    EXPECT_EQ(sum_of(1, 6), whole);
    compared += whole.size();
  });
  EXPECT_GT(compared, 500 / one_in);
}

// Law V9.
TEST(VisibilityLaws, AddingAFacetUncoversNothing) {
  on_all_scenes(701, 16, [&](const Scene& scene, Random& random) {
    const auto before = areas_of(scene.mesh, scene.tubes);
    FacetMesh mesh = scene.mesh;
    // Its vertices are vertices of the scene: it touches, and often cuts, other facets.
    const auto any = [&] { return mesh.facets[random() % mesh.facets.size()][random() % 3]; };
    const VertexId a = any(), b = any(), c = any();
    add_facet(mesh, a, b, c);
    const auto after = areas_of(mesh, scene.tubes);
    for (std::size_t t = 0; t < after.size(); ++t)
      for (const auto& [facet, area] : after[t])
        if (facet + 1 < mesh.facets.size()) {
          EXPECT_TRUE(before[t].contains(facet) && area <= before[t].at(facet)) << "facet " << facet;
        }
  });
}

// Law V10.
TEST(VisibilityLaws, NothingIsSeenThroughAWall) {
  for (std::uint64_t seed = 801; seed < 801 + 40 / one_in; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    FacetMesh mesh = make_random_triangles(random, 40, 1000, 500);
    const auto behind = static_cast<FacetId>(mesh.facets.size());
    // A rough wall of small facets with or without shared edges (T-junctions). Its relief stays before the
    // random triangles.
    FacetMesh wall;
    add_plate(wall, 100, 12, 15, seed % 2 == 0);
    if (seed % 2)
      for (GridPoint& p : wall.vertices) p.y += uniform(random, -60, 300);
    const auto shift = static_cast<VertexId>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), wall.vertices.begin(), wall.vertices.end());
    for (const auto& v : wall.facets) add_facet(mesh, v[0] + shift, v[1] + shift, v[2] + shift);
    const auto areas = areas_of(mesh, lattice_tubes({0, 0, 0}, -5, -3, 10, 6, 24));
    EXPECT_EQ(areas.size(), 60u);
    for (const Areas& tube : areas) {
      ASSERT_FALSE(tube.empty());
      EXPECT_GE(tube.begin()->first, behind) << "a facet behind the wall is seen";
    }
  }
}

// Law F2.
TEST(VisibilityLaws, OfCoincidentFacetsExactlyOneIsSeen) {
  for (std::uint64_t seed = 901; seed < 901 + 40 / one_in; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    FacetMesh mesh = seed % 2 ? make_random_triangles(random, 12, 1000000, 600000)
                              : make_random_triangles(random, 12, 8, 3);
    const TubeSet tubes = lattice_tubes({0, 0, 0}, -2, -2, 4, 4, 3);
    const auto count = static_cast<FacetId>(mesh.facets.size());
    const auto once = areas_of(mesh, tubes);
    duplicate_facets(random, mesh, seed % 3 == 0);
    const auto twice = areas_of(mesh, tubes);
    for (std::size_t t = 0; t < twice.size(); ++t) {
      Areas merged;
      for (const auto& [facet, area] : twice[t]) {
        EXPECT_FALSE(twice[t].contains(facet + count)) << "both copies of facet " << facet << " are seen";
        merged[facet % count] += area;
      }
      // The tiny grid has its own coincident facets, of which either may be visible.
      if (seed % 2) {
        EXPECT_EQ(merged, once[t]) << "tube " << t;
      }
    }
  }
}

TEST(VisibilityLaws, PlainDoubleIsNotExactWhereFixedIs) {
  std::size_t broken = 0;
  on_all_scenes(1001, 6, [&](const Scene& scene, Random&) {
    const Look fixed = look(scene.mesh, scene.tubes);
    const Look plain = look(scene.mesh, scene.tubes, with(Arithmetic::plain_double));
    EXPECT_EQ(fixed.not_closed, 0u);
    broken += plain.not_closed > 0 || plain.hash != fixed.hash;
  });
  EXPECT_GT(broken, 0u) << "double is exact on all of these scenes: they stumble over nothing";
}

}  // namespace
}  // namespace tubefoot
