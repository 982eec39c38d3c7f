// SPDX-License-Identifier: GPL-3.0-or-later
// Tests mirror images of points, facets and tubes, tubes of visible polygons of mirrors, and lines of
// sight. The comparisons are exact rationals.

#include "geometry/tubes/mirror.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <random>

#include "fixtures/geometry/grid_scenes.hpp"
#include "fixtures/geometry/looks.hpp"
#include "geometry/search/line_of_sight.hpp"
#include "geometry/tubes/window_tubes.hpp"

namespace tubefoot {
namespace {

glm::dvec3 real(GridPoint p) { return {p.x, p.y, p.z}; }

// Law I1.
TEST(Mirror, HorizontalImagesAreExact) {
  const MirrorPlane surface = MirrorPlane::horizontal(17);
  EXPECT_EQ(surface.image({5, -6, -100}), (GridPoint{5, -6, 134}));
  EXPECT_GT(surface.side({0, 0, 16}), 0);
  EXPECT_EQ(surface.side({9, 9, 17}), 0);
  EXPECT_EQ(surface.reflection() * glm::dvec3(1, 2, 3), glm::dvec3(1, 2, -3));
  EXPECT_THROW(surface.image({0, 0, -2147483647}), GridRangeError);
}

// Law I1.
TEST(Mirror, ImagesAreNearestGridPointsAndBackAgain) {
  const unsigned seed = 8128;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  test::Random random(seed);
  for (int i = 0; i < 2000; ++i) {
    const FacetMesh mesh = test::make_random_triangles(random, 1, 1 << 20, 1 << 22);
    if (is_degenerate(mesh.vertices[0], mesh.vertices[1], mesh.vertices[2])) continue;
    const GridPoint p{test::uniform(random, -(1 << 24), 1 << 24), test::uniform(random, -(1 << 24), 1 << 24),
                      test::uniform(random, -(1 << 24), 1 << 24)};
    const MirrorPlane plane = MirrorPlane::of_facet(mesh, 0, p);
    ASSERT_GT(plane.side(p), 0);
    for (const GridPoint v : mesh.vertices) ASSERT_EQ(plane.side(v), 0);
    const GridPoint image = plane.image(p);
    // Both points have the same distance from each point of the plane, along its normal, except for
    // rounding.
    for (const GridPoint v : mesh.vertices)
      ASSERT_NEAR(glm::distance(real(v), real(p)), glm::distance(real(v), real(image)), 0.9);
    const glm::dvec3 along = real(image) - real(p);
    ASSERT_LT(glm::length(glm::cross(along, plane.unit_normal())), 0.9);
    ASSERT_LT(glm::distance(real(plane.image(image)), real(p)), 1.8);
    ASSERT_LT(glm::distance(plane.reflection() * along, -along), 1e-6 + 2);
  }
}

TEST(Mirror, CoplanarFacetsHaveTheSamePlaneAndItsSidesDiffer) {
  FacetMesh mesh;
  for (const GridPoint p : {GridPoint{0, 0, 0}, {6, 0, 3}, {0, 4, 2}, {12, -4, 4}, {6, 4, 5}})
    test::add_vertex(mesh, p);
  test::add_facet(mesh, 0, 1, 2);
  test::add_facet(mesh, 3, 1, 4);
  test::add_facet(mesh, 0, 1, 4);
  const GridPoint above{0, 0, 100}, below{0, 0, -100};
  const MirrorPlane first = MirrorPlane::of_facet(mesh, 0, above);
  EXPECT_TRUE(first == MirrorPlane::of_facet(mesh, 2, above));
  EXPECT_TRUE(first == MirrorPlane::of_facet(mesh, 1, above));
  EXPECT_FALSE(first == MirrorPlane::of_facet(mesh, 0, below));
  EXPECT_TRUE(first < MirrorPlane::of_facet(mesh, 0, below) || MirrorPlane::of_facet(mesh, 0, below) < first);
}

// Law I2.
TEST(Mirror, FacetsEndAtThePlane) {
  FacetMesh mesh;
  for (const GridPoint p :
       {GridPoint{0, 0, -10}, {10, 0, -10}, {0, 10, -10}, {0, 0, 10}, {20, 0, 10}, {5, 5, 0}, {7, 9, 0}})
    test::add_vertex(mesh, p);
  test::add_facet(mesh, 0, 1, 2);  // below
  test::add_facet(mesh, 0, 1, 3);  // one corner above
  test::add_facet(mesh, 0, 3, 4);  // two corners above
  test::add_facet(mesh, 3, 4, 5);  // above, one corner on it
  test::add_facet(mesh, 1, 5, 6);  // below, an edge on it
  test::add_facet(mesh, 0, 5, 3);  // a corner on it, the others on either side
  const std::vector<FacetId> all{0, 1, 2, 3, 4, 5};
  const MeshPart part = in_front_of(MirrorPlane::horizontal(0), mesh, all);
  EXPECT_EQ(part.origin, (std::vector<FacetId>{0, 1, 1, 2, 4, 5}));
  const auto area = [](const FacetMesh& m, FacetId f) {
    const auto& [a, b, c] = m.facets[f];
    return glm::length(
        glm::cross(real(m.vertices[b]) - real(m.vertices[a]), real(m.vertices[c]) - real(m.vertices[a])));
  };
  EXPECT_EQ(area(part.mesh, 0), area(mesh, 0));
  EXPECT_EQ(area(part.mesh, 1) + area(part.mesh, 2), 0.75 * area(mesh, 1));
  EXPECT_EQ(area(part.mesh, 3), 0.25 * area(mesh, 2));
  EXPECT_EQ(area(part.mesh, 4), area(mesh, 4));
  EXPECT_EQ(area(part.mesh, 5), 0.5 * area(mesh, 5));
  for (const GridPoint v : part.mesh.vertices) EXPECT_LE(v.z, 0);
}

/// Exact gnomonic area of all tubes of a set, in the plane of `axis`.
CGAL::Exact_rational area_of(const TubeSet& set, const ExactVector& axis) {
  CGAL::Exact_rational sum = 0;
  for (const Tube& tube : set.tubes) {
    std::vector<ExactVector> directions;
    for (const std::uint32_t ray : tube) directions.push_back(exact(set.rays[ray]));
    sum += gnomonic_area(axis, directions);
  }
  return sum;
}

// Law B4.
TEST(WindowTubes, AFanOfConesIsTheirUnionExactly) {
  // Cones of 3 to 9 corners about a common ray. All corners belong to one convex cone, so that the areas
  // add up to the area of this cone.
  const ExactVector axis{0, 0, -1};
  std::vector<glm::dvec3> rim;
  for (int k = 0; k < 9; ++k) rim.push_back({std::cos(0.7 * k), std::sin(0.7 * k), -1.3});
  for (std::size_t cut = 2; cut < 8; ++cut) {
    WindowTubes whole({1, 2, 3}, 10), parts({1, 2, 3}, 10);
    std::vector<glm::dvec3> turned(rim.rbegin(), rim.rend());  // so that they have the orientation of tubes
    whole.add(turned, 7);
    parts.add(std::vector<glm::dvec3>(turned.begin(), turned.begin() + std::ptrdiff_t(cut) + 1), 8);
    std::vector<glm::dvec3> rest(turned.begin() + std::ptrdiff_t(cut), turned.end());
    rest.push_back(turned.front());
    parts.add(rest, 9);
    ASSERT_GT(area_of(whole.tubes(), axis), 0);
    EXPECT_EQ(area_of(whole.tubes(), axis), area_of(parts.tubes(), axis)) << cut;
    EXPECT_EQ(whole.labels(), std::vector<std::uint32_t>(whole.tubes().tubes.size(), 7));
  }
}

// Tubes whose fourth ray lies in the wall of two others: their visible polygons obey the closure law.
TEST(WindowTubes, TubesOfThreeCornersCloseExactly) {
  const unsigned seed = 496;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  test::Random random(seed);
  for (int i = 0; i < 60; ++i) {
    const FacetMesh mesh = test::make_random_triangles(random, 12, 1 << 16, 1 << 15);
    WindowTubes windows({0, 0, 0}, 1e9);
    windows.add(std::vector<glm::dvec3>{{0.1, 1, 0.5}, {0.6, 1, -0.3}, {-0.5, 1, -0.4}}, 0);
    windows.add(
        std::vector<glm::dvec3>{{-0.8, 1, -0.2}, {-1, 1, 0}, {-0.9, 1, 0.6}, {0.1, 1, 0.5}, {-0.5, 1, -0.4}},
        1);
    ASSERT_EQ(windows.tubes().tubes.size(), 3u);
    EXPECT_EQ(test::look(mesh, windows.tubes()).not_closed, 0u) << i;
  }
}

TEST(WindowTubes, LeavesOutWhatRoundingMakesFlat) {
  WindowTubes windows({0, 0, 0}, 1);
  windows.add(std::vector<glm::dvec3>{{0, 1, 1}, {1e-10, 1, 0}, {0, 1, 0}}, 0);
  windows.add(std::vector<glm::dvec3>{{0, 1, 2}, {0, 1, 1}, {0, 1, 0}}, 0);
  EXPECT_TRUE(windows.tubes().tubes.empty());
  windows.add(std::vector<glm::dvec3>{{0, 1, 1}, {0.5, 1, 1}, {1, 1, 1}, {1, 1, 1e-11}, {1, 1, 0}, {0, 1, 0}},
              0);
  ASSERT_EQ(windows.tubes().tubes.size(), 1u);
  EXPECT_TRUE(holds(windows.tubes(), 0, {1, 2, 1}));
  EXPECT_TRUE(holds(windows.tubes(), 0, {0, 1, 0}));
  EXPECT_FALSE(holds(windows.tubes(), 0, {-1, 1 << 29, 1000}));
  EXPECT_TRUE(holds(windows.tubes(), 0, {-1, 1 << 29, 1000}, 2e-9));
  EXPECT_FALSE(holds(windows.tubes(), 0, {-1, 1 << 29, 1000}, 1e-9));
}

// Law I3.
TEST(LineOfSight, AgreesWithRationalsOnSmallNumbers) {
  const unsigned seed = 33550336;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  test::Random random(seed);
  const auto small = [&] {
    return GridPoint{test::uniform(random, -4, 4), test::uniform(random, -4, 4),
                     test::uniform(random, -4, 4)};
  };
  int hidden = 0, touching = 0;
  for (int i = 0; i < 3000; ++i) {
    const FacetMesh mesh = test::make_random_triangles(random, 1, 0, 4);
    const SceneTree tree(mesh);
    const GridPoint from = small(), to = small();
    if (from == to) continue;
    const GridPoint a = mesh.vertices[mesh.facets[0][0]], b = mesh.vertices[mesh.facets[0][1]],
                    c = mesh.vertices[mesh.facets[0][2]];
    const ExactVector u = difference(exact(b), exact(a)), v = difference(exact(c), exact(a)), n = cross(u, v),
                      d = difference(exact(to), exact(from));
    const CGAL::Exact_rational nn = dot(n, n), down = dot(n, d),
                               high = dot(n, difference(exact(a), exact(from)));
    bool expected = false;
    if (nn != 0 && down != 0 && high != 0) {
      const CGAL::Exact_rational t = high / down;
      ExactVector p = difference(exact(from), exact(a));
      for (int k = 0; k < 3; ++k) p[k] += t * d[k];
      const CGAL::Exact_rational x = dot(cross(p, v), n) / nn, y = dot(cross(u, p), n) / nn;
      expected = t > 0 && t < 1 && x >= 0 && y >= 0 && x + y <= 1;
      touching += expected && (x == 0 || y == 0 || x + y == 1);
      if (expected) {
        EXPECT_TRUE(in_view(mesh, tree, from, to, CGAL::to_double(t) * (1 + 1e-12)));
        EXPECT_FALSE(in_view(mesh, tree, from, to, CGAL::to_double(t) * (1 - 1e-12)));
      }
    }
    hidden += expected;
    EXPECT_EQ(in_view(mesh, tree, from, to), !expected) << i;
  }
  EXPECT_GT(hidden, 30);
  EXPECT_GT(touching, 10);
}

}  // namespace
}  // namespace tubefoot
