// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the search tree of facets. A query returns each facet that may meet a pyramid within the range
// limit, and few others.

#include "geometry/search/scene_tree.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <set>

#include "fixtures/geometry/grid_scenes.hpp"
#include "geometry/mesh/facet_cone.hpp"
#include "geometry/visibility/visibility.hpp"

namespace tubefoot {
namespace {

using namespace test;

constexpr double everywhere = std::numeric_limits<double>::infinity();

std::vector<Vec64> walls_of(const TubeSet& tubes, std::uint32_t tube) {
  std::vector<Vec64> walls;
  const Tube& t = tubes.tubes[tube];
  for (int k = 0; k < 4; ++k) walls.push_back(cross(tubes.rays[t[k]], tubes.rays[t[(k + 1) % 4]]));
  return walls;
}

std::vector<FacetId> query(const SceneTree& tree, GridPoint apex, const std::vector<Vec64>& walls,
                           double reach = everywhere) {
  std::vector<SceneTree::HalfSpace> half_spaces;
  for (const Vec64& n : walls)
    half_spaces.push_back({static_cast<double>(n.x), static_cast<double>(n.y), static_cast<double>(n.z)});
  std::vector<FacetId> found;
  tree.query(apex, half_spaces, reach, found);
  std::sort(found.begin(), found.end());
  EXPECT_EQ(std::adjacent_find(found.begin(), found.end()), found.end()) << "a facet found twice";
  return found;
}

/// Returns, exactly, whether the facet may have a part inside the pyramid: no wall has all its vertices on
/// or outside.
bool may_meet(const FacetMesh& mesh, FacetId f, GridPoint apex, const std::vector<Vec64>& walls) {
  return std::all_of(walls.begin(), walls.end(), [&](const Vec64& n) {
    return std::any_of(mesh.facets[f].begin(), mesh.facets[f].end(),
                       [&](VertexId v) { return dot(n, mesh.vertices[v] - apex) > 0; });
  });
}

/// Distance of the box of a facet from the apex.
double box_distance(const FacetMesh& mesh, FacetId f, GridPoint apex) {
  double sum = 0;
  for (const auto axis : {&GridPoint::x, &GridPoint::y, &GridPoint::z}) {
    double lo = everywhere, hi = -everywhere;
    for (const VertexId v : mesh.facets[f]) {
      lo = std::min(lo, double(mesh.vertices[v].*axis) - apex.*axis);
      hi = std::max(hi, double(mesh.vertices[v].*axis) - apex.*axis);
    }
    const double gap = std::max({lo, -hi, 0.0});
    sum += gap * gap;
  }
  return std::sqrt(sum);
}

// Law T1.
TEST(SceneTree, MissesNoFacetThatMeetsThePyramid) {
  std::size_t expected = 0, returned = 0, requested = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed)
    for (const Scene& scene : adversarial_cases(seed)) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", " << scene.name);
      const SceneTree tree(scene.mesh);
      for (std::uint32_t t = 0; t < scene.tubes.tubes.size(); ++t) {
        const auto walls = walls_of(scene.tubes, t);
        const auto found = query(tree, scene.tubes.apex, walls);
        returned += found.size();
        requested += scene.mesh.facets.size();
        for (FacetId f = 0; f < scene.mesh.facets.size(); ++f)
          if (may_meet(scene.mesh, f, scene.tubes.apex, walls)) {
            ++expected;
            EXPECT_TRUE(std::binary_search(found.begin(), found.end(), f)) << "facet " << f << ", tube " << t;
          }
      }
    }
  EXPECT_GT(expected, 5000u);
  EXPECT_LT(returned, requested * 9 / 10) << "the tree sorts nothing out";
}

TEST(SceneTree, FindsLittleMoreOnALargeMesh) {
  Random random(7);
  const FacetMesh mesh = rough_terrain(random, 128, 200000000, -20000000, 1000000);
  const SceneTree tree(mesh);
  const TubeSet tubes = forward_tubes({0, 0, 0}, 12, 4, 60, 20, 12);
  std::size_t expected = 0, returned = 0;
  for (std::uint32_t t = 0; t < tubes.tubes.size(); ++t) {
    const auto walls = walls_of(tubes, t);
    const auto found = query(tree, tubes.apex, walls);
    returned += found.size();
    for (FacetId f = 0; f < mesh.facets.size(); ++f)
      if (may_meet(mesh, f, tubes.apex, walls)) {
        ++expected;
        EXPECT_TRUE(std::binary_search(found.begin(), found.end(), f)) << "facet " << f << ", tube " << t;
      }
  }
  EXPECT_GT(expected, 5000u);
  // The tree tests boxes, and against four planes only: it returns some facets too many, but not most of
  // the mesh.
  EXPECT_LT(returned, 3 * expected);
  EXPECT_GT(tree.bytes(), mesh.facets.size() * sizeof(FacetId));
}

TEST(SceneTree, RespectsTheReach) {
  for (std::uint64_t seed = 41; seed <= 50; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const FacetMesh mesh = make_random_triangles(random, 200, 1000000, 900000);
    const SceneTree tree(mesh);
    const GridPoint apex{uniform(random, -1000, 1000), 0, 0};
    for (const double reach : {0.0, 200000.0, 700000.0, 1200000.0, 3000000.0}) {
      const auto found = query(tree, apex, {}, reach);
      for (FacetId f = 0; f < mesh.facets.size(); ++f) {
        const double distance = box_distance(mesh, f, apex);
        const bool is_found = std::binary_search(found.begin(), found.end(), f);
        if (std::abs(distance - reach) <= reach * 1e-9) continue;
        EXPECT_EQ(is_found, distance < reach) << "facet " << f << " at " << distance;
      }
    }
  }
}

TEST(SceneTree, FindsAllInBoxesThatAreNotRefused) {
  for (const Scene& scene : adversarial_cases(5)) {
    SCOPED_TRACE(scene.name);
    if (scene.mesh.facets.empty()) continue;
    const SceneTree tree(scene.mesh);
    std::vector<FacetId> all, none, some;
    tree.query([](const GridPoint&, const GridPoint&) { return true; }, all);
    EXPECT_EQ(all.size(), scene.mesh.facets.size());
    tree.query([](const GridPoint&, const GridPoint&) { return false; }, none);
    EXPECT_TRUE(none.empty());
    // Boxes that extend below a height.
    const std::int32_t height = scene.mesh.vertices[scene.mesh.facets.front()[0]].x;
    std::size_t requested = 0;
    tree.query(
        [&](const GridPoint& lowest, const GridPoint& highest) {
          ++requested;
          EXPECT_LE(lowest.x, highest.x);
          return lowest.x <= height;
        },
        some);
    std::sort(some.begin(), some.end());
    EXPECT_EQ(std::adjacent_find(some.begin(), some.end()), some.end());
    EXPECT_GT(requested, 0u);
    for (FacetId f = 0; f < scene.mesh.facets.size(); ++f)
      if (std::ranges::any_of(scene.mesh.facets[f],
                              [&](VertexId v) { return scene.mesh.vertices[v].x <= height; })) {
        EXPECT_TRUE(std::binary_search(some.begin(), some.end(), f));
      }
  }
}

// Law T2. The small tree is that of the last facets, whose vertices move between the queries.
TEST(SceneTree, OfTwoLevelsFindsWhatOneTreeFinds) {
  std::size_t of_lower = 0, of_upper = 0;
  const auto visible_facets = [](const TubeVisibility& seen) {
    std::set<FacetId> facets;
    for (const NamedPiece& piece : seen.pieces) facets.insert(piece.facet);
    return facets;
  };
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    FacetMesh mesh = seed % 2 == 0 ? make_random_triangles(random, 300, 1000000, 900000)
                                   : rough_terrain(random, 12, 2000000, -300000, 20000);
    const FacetMesh at_rest = mesh;
    const auto lower = std::make_shared<const SceneTree>(at_rest);
    const auto first = static_cast<FacetId>(mesh.facets.size());
    const std::size_t first_vertex = mesh.vertices.size();
    const FacetMesh moving = make_random_triangles(random, 60, 1000000, 300000);
    for (const auto& [a, b, c] : moving.facets)
      add_facet(mesh, static_cast<VertexId>(first_vertex + a), static_cast<VertexId>(first_vertex + b),
                static_cast<VertexId>(first_vertex + c));
    mesh.vertices.insert(mesh.vertices.end(), moving.vertices.begin(), moving.vertices.end());
    const TubeSet tubes = forward_tubes({0, 0, 0}, 6, 3, 60, 30, 0);
    for (int move = 0; move < 3; ++move) {
      for (std::size_t v = first_vertex; v < mesh.vertices.size(); ++v) mesh.vertices[v].x += 150000;
      const SceneTree one(mesh, SceneTree::HeightFieldSearch::ignored), two(mesh, lower, first);
      EXPECT_EQ(two.height_fields(), lower->height_fields());
      VisibilityScratch scratch;
      TubeVisibility seen, expected;
      for (std::uint32_t t = 0; t < tubes.tubes.size(); ++t) {
        const auto walls = walls_of(tubes, t);
        for (const double reach : {900000.0, everywhere}) {
          const auto found = query(two, tubes.apex, walls, reach);
          EXPECT_EQ(found, query(one, tubes.apex, walls, reach)) << "tube " << t;
          for (const FacetId f : found) ++(f < first ? of_lower : of_upper);
        }
        // Height fields of the facets at rest hide none of the moving facets.
        see(mesh, two, tubes, t, {}, scratch, seen);
        see(mesh, one, tubes, t, {}, scratch, expected);
        EXPECT_EQ(visible_facets(seen), visible_facets(expected)) << "tube " << t;
      }
      std::vector<FacetId> all;
      two.query([](const GridPoint&, const GridPoint&) { return true; }, all);
      EXPECT_EQ(all.size(), mesh.facets.size());
    }
  }
  EXPECT_GT(of_lower, 1000u);
  EXPECT_GT(of_upper, 1000u);
}

TEST(SceneTree, AnEmptyMeshHasNothingToFind) {
  FacetMesh mesh;
  EXPECT_TRUE(query(SceneTree(mesh), {0, 0, 0}, {}).empty());
  add_vertex(mesh, {1, 2, 3});
  EXPECT_TRUE(query(SceneTree(mesh), {0, 0, 0}, {}).empty());
}

TEST(SceneTree, KeepsAlikeDegenerateAndExtremeFacets) {
  constexpr std::int32_t far = 1 << 30;
  FacetMesh mesh;
  for (int k = 0; k < 100; ++k) {  // nothing to split by
    const VertexId a = add_vertex(mesh, {-1, 5, -1}), b = add_vertex(mesh, {1, 5, -1}),
                   c = add_vertex(mesh, {0, 5, 1});
    add_facet(mesh, a, b, c);
    add_facet(mesh, a, a, a);
  }
  const VertexId p = add_vertex(mesh, {-far, far, -far}), q = add_vertex(mesh, {far, far, -far}),
                 r = add_vertex(mesh, {far, far, far});
  add_facet(mesh, p, q, r);
  const SceneTree tree(mesh);
  EXPECT_EQ(query(tree, {0, 0, 0}, {}).size(), mesh.facets.size());
  const auto ahead = query(tree, {0, 0, 0}, walls_of(lattice_tubes({0, 0, 0}, -3, -3, 6, 6, 3), 14));
  EXPECT_TRUE(std::binary_search(ahead.begin(), ahead.end(), static_cast<FacetId>(mesh.facets.size() - 1)));
  const auto behind = query(tree, {0, 0, 0}, {Vec64{0, -1, 0}});
  EXPECT_TRUE(behind.empty());
}

// Law V11.
TEST(SceneTree, BeyondTheReachNothingIsSeenAndNothingHides) {
  FacetMesh mesh;
  add_plate(mesh, 100, 2, 100, false);
  const auto far = static_cast<FacetId>(mesh.facets.size());
  add_plate(mesh, 200, 2, 400, false);
  const SceneTree tree(mesh);
  TubeSet tubes = lattice_tubes({0, 0, 0}, -1, -1, 2, 2, 5);
  VisibilityScratch scratch;
  TubeVisibility seen;
  const auto facets_seen = [&](GridPoint apex, double reach) {
    tubes.apex = apex;
    tubes.reach = reach;
    std::size_t near_ones = 0, far_ones = 0;
    for (std::uint32_t t = 0; t < tubes.tubes.size(); ++t) {
      see(mesh, tree, tubes, t, {}, scratch, seen);
      for (const NamedPiece& piece : seen.pieces) ++(piece.facet < far ? near_ones : far_ones);
    }
    return std::pair{near_ones > 0, far_ones > 0};
  };
  EXPECT_EQ(facets_seen({0, 0, 0}, 50), (std::pair{false, false}));
  EXPECT_EQ(facets_seen({0, 0, 0}, 150), (std::pair{true, false}));
  EXPECT_EQ(facets_seen({0, 0, 0}, 1000), (std::pair{true, false}));
  EXPECT_EQ(facets_seen({0, 150, 0}, 1000), (std::pair{false, true}));
  EXPECT_EQ(facets_seen({0, 150, 0}, 40), (std::pair{false, false}));
}

// Three facets with one centroid, each a thousand times: no split separates them.
TEST(SceneTree, HoldsTheFirstOfManyCopies) {
  FacetMesh mesh;
  mesh.vertices = {{-30, 100, -30}, {60, 100, -30}, {-30, 100, 60}, {30, 100, 30}, {-60, 100, 30},
                   {30, 100, -60},  {-30, 70, -30}, {60, 100, -30}, {-30, 130, 60}};
  for (int k = 0; k < 1000; ++k) {
    // The order of the vertices, and so the side, does not matter.
    if (k % 2 == 0)
      mesh.facets.insert(mesh.facets.end(), {{0, 1, 2}, {3, 4, 5}, {6, 7, 8}});
    else
      mesh.facets.insert(mesh.facets.end(), {{2, 1, 0}, {5, 3, 4}, {8, 7, 6}});
  }
  mesh.material.assign(mesh.facets.size(), 0);
  mesh.component.assign(mesh.facets.size(), 0);
  const SceneTree tree(mesh);
  const TubeSet tubes = lattice_tubes({0, 0, 0}, -1, -1, 2, 2, 1);
  EXPECT_EQ(query(tree, {0, 0, 0}, walls_of(tubes, 0)), (std::vector<FacetId>{0, 1, 2}));
  EXPECT_LT(tree.bytes(), 100'000u);
}

/// All boxes of a tree in the order of a query, and its facets.
struct Shape {
  std::vector<std::array<std::int32_t, 6>> boxes;
  std::vector<FacetId> facets;
  std::size_t bytes = 0;

  friend bool operator==(const Shape&, const Shape&) = default;
};

Shape shape_by(int threads, const FacetMesh& mesh) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, std::size_t(threads));
  tbb::task_arena arena(threads);
  Shape shape;
  arena.execute([&] {
    const SceneTree tree(mesh, SceneTree::HeightFieldSearch::ignored);
    tree.query(
        [&](const GridPoint& lo, const GridPoint& hi) {
          shape.boxes.push_back({lo.x, lo.y, lo.z, hi.x, hi.y, hi.z});
          return true;
        },
        shape.facets);
    shape.bytes = tree.bytes();
  });
  return shape;
}

// Several threads divide a large mesh. In the second half of the cases, facets in its middle have many
// copies.
TEST(SceneTree, IsTheSameByAnyNumberOfThreads) {
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    FacetMesh mesh;
    for (int k = 0; k < 25000; ++k) {
      const auto corner = [&] {
        return add_vertex(mesh, {uniform(random, -90'000, 90'000), uniform(random, -90'000, 90'000),
                                 uniform(random, -900, 900)});
      };
      const VertexId a = corner(), b = corner(), c = corner();
      add_facet(mesh, a, b, c);
    }
    const auto facets = static_cast<FacetId>(mesh.facets.size());
    if (seed >= 2)
      for (FacetId f = 0; f < 40; ++f)
        for (int copy = 0; copy < 100; ++copy) {
          const auto [a, b, c] = mesh.facets[100 * f];
          add_facet(mesh, b, c, a);
        }
    const Shape one = shape_by(1, mesh);
    for (const int threads : {2, 5}) EXPECT_TRUE(shape_by(threads, mesh) == one) << threads;
    std::vector<FacetId> found = one.facets;
    std::ranges::sort(found);
    EXPECT_EQ(std::ranges::adjacent_find(found), found.end());
    for (FacetId f = 0; f < facets; ++f) EXPECT_TRUE(std::ranges::binary_search(found, f)) << f;
    if (seed < 2) {
      EXPECT_EQ(found.size(), facets);
    }
    EXPECT_LT(found.size(), facets + 40u * 50);  // some copies remain next to other facets
    EXPECT_GT(one.boxes.size(), facets / 8);
  }
}

}  // namespace
}  // namespace tubefoot
