// SPDX-License-Identifier: GPL-3.0-or-later
// Tests closed shells of a mesh, and whether a shell encloses a point, for points over vertices and edges,
// and for open shells.
#include <gtest/gtest.h>

#include "fixtures/geometry/grid_scenes.hpp"
#include "fixtures/geometry/layered_scenes.hpp"
#include "geometry/mesh/closed_shells.hpp"
#include "geometry/search/vertical_line.hpp"

namespace tubefoot {
namespace {

using namespace test;

class Enclosure {
 public:
  explicit Enclosure(const FacetMesh& mesh) : mesh_(mesh), tree_(mesh_), shells_(mesh_, 0) {}
  bool holds(GridPoint point) const {
    std::vector<FacetId> near;
    facets_near_vertical(tree_, point, near);
    return is_enclosed(mesh_, shells_, near, point);
  }
  std::size_t shells() const { return shells_.count(); }

 private:
  FacetMesh mesh_;
  SceneTree tree_;
  ClosedShells shells_;
};

/// Returns the mesh without some facets.
FacetMesh without(FacetMesh mesh, std::size_t first, std::size_t count) {
  const auto drop = [&](auto& list) {
    list.erase(list.begin() + static_cast<std::ptrdiff_t>(first),
               list.begin() + static_cast<std::ptrdiff_t>(first + count));
  };
  drop(mesh.facets), drop(mesh.material), drop(mesh.component);
  return mesh;
}

// Law F4: some lines contain edges, vertices and vertical faces of the box.
TEST(Enclosure, OfABoxIsEveryPlaceInIt) {
  FacetMesh mesh;
  add_box(mesh, {0, 0, 0}, 8);
  const Enclosure box(mesh);
  EXPECT_EQ(box.shells(), 1u);
  for (std::int32_t x = -9; x <= 9; ++x)
    for (std::int32_t y = -9; y <= 9; ++y)
      for (const std::int32_t z : {-9, -7, 0, 7, 9}) {
        if (std::max(std::abs(x), std::abs(y)) == 8 && std::abs(z) < 8) continue;  // on it
        const bool in = std::max({std::abs(x), std::abs(y), std::abs(z)}) < 8;
        EXPECT_EQ(box.holds({x, y, z}), in) << x << " " << y << " " << z;
      }
}

// Law N6, and F4 for lines that all contain a vertex or an edge.
TEST(Enclosure, IsExactThroughVerticesAndEdges) {
  FacetMesh mesh;
  add_octahedron(mesh, {0, 0, 0}, 1 << 20);
  const Enclosure octahedron(mesh);
  for (const std::int32_t x : {0, 1, -1, 1 << 19, -(1 << 19), (1 << 20) - 1, 1 << 20, (1 << 20) + 1})
    for (const std::int32_t y : {0, 1, -1, 1 << 18})
      for (const std::int32_t z : {0, 5, -(1 << 18)}) {
        const std::int64_t off = std::int64_t(std::abs(x)) + std::abs(y) + std::abs(z) - (1 << 20);
        if (off == 0) continue;  // on it
        EXPECT_EQ(octahedron.holds({x, y, z}), off < 0) << x << " " << y << " " << z;
      }
}

TEST(Enclosure, BetweenTwoSpheresAndInTheInnerOneIsInside) {
  FacetMesh mesh;
  add_sphere(mesh, {0, 0, 0}, 1e6, 3);
  add_sphere(mesh, {0, 0, 0}, 4e5, 3);
  const Enclosure spheres(mesh);
  EXPECT_EQ(spheres.shells(), 2u);
  Random random(4);
  for (int n = 0; n < 2000; ++n) {
    const GridPoint p{uniform(random, -1200000, 1200000), uniform(random, -1200000, 1200000),
                      uniform(random, -1200000, 1200000)};
    const double r = std::sqrt(double(p.x) * p.x + double(p.y) * p.y + double(p.z) * p.z);
    if (r > 9.7e5 && r < 1.001e6) continue;  // facets lie slightly inside the sphere
    EXPECT_EQ(spheres.holds(p), r < 9.7e5) << r;
  }
  EXPECT_TRUE(spheres.holds({0, 0, 0}));
}

// A point in both of two bodies that overlap has an even number of surfaces above.
TEST(Enclosure, ByTwoBodiesOfOneMeshIsInside) {
  FacetMesh mesh;
  add_box(mesh, {0, 0, 0}, 8);
  add_box(mesh, {5, 3, 4}, 8);
  const Enclosure boxes(mesh);
  EXPECT_EQ(boxes.shells(), 2u);
  EXPECT_TRUE(boxes.holds({2, 2, 2}));
  EXPECT_TRUE(boxes.holds({-6, 0, 0}));
  EXPECT_TRUE(boxes.holds({12, 10, 11}));
  EXPECT_FALSE(boxes.holds({-6, 10, 10}));
}

TEST(Enclosure, NothingIsInsideOfWhatIsOpen) {
  FacetMesh mesh;
  add_box(mesh, {0, 0, 0}, 8);
  for (std::size_t side = 0; side < 12; side += 2) {
    const Enclosure open(without(mesh, side, 2));
    EXPECT_EQ(open.shells(), 0u);
    EXPECT_FALSE(open.holds({0, 1, 2}));
  }
  // One missing facet of twelve lets sound in. A closed body next to it stays closed.
  FacetMesh two = without(mesh, 3, 1);
  add_box(two, {40, 0, 0}, 8);
  const Enclosure both(two);
  EXPECT_EQ(both.shells(), 1u);
  EXPECT_FALSE(both.holds({0, 1, 2}));
  EXPECT_TRUE(both.holds({40, 1, 2}));
}

// Some programs write both sides of each facet.
TEST(Enclosure, FacetsThatAreThereTwiceCountOnce) {
  FacetMesh mesh;
  add_box(mesh, {0, 0, 0}, 8);
  const std::size_t facets = mesh.facets.size();
  for (std::size_t k = 0; k < facets; ++k) {
    const auto [a, b, c] = mesh.facets[k];
    add_facet(mesh, c, b, a);
  }
  const Enclosure box(mesh);
  EXPECT_EQ(box.shells(), 1u);
  EXPECT_TRUE(box.holds({1, 2, 3}));
  EXPECT_FALSE(box.holds({1, 2, 9}));
}

TEST(ClosedShells, AreOfOneComponentAndSkipWhatHasNoArea) {
  FacetMesh mesh;
  add_box(mesh, {0, 0, 0}, 8);
  add_facet(mesh, 0, 1, 1);  // collapsed on the grid: an edge, twice
  mesh.component[4] = 1;
  EXPECT_EQ(ClosedShells(mesh, 0).count(), 0u);
  mesh.component[4] = 0;
  const ClosedShells shells(mesh, 0);
  EXPECT_EQ(shells.count(), 1u);
  EXPECT_EQ(shells.shell_of(4), 0u);
  EXPECT_EQ(shells.shell_of(99), std::nullopt);
  EXPECT_EQ(ClosedShells(mesh, 7).count(), 0u);
}

}  // namespace
}  // namespace tubefoot
