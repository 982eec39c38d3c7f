// SPDX-License-Identifier: GPL-3.0-or-later
// Tests exact degeneracy of triangles and `MeshBuilder`, which merges equal grid points, counts degenerate
// and duplicate facets, and rejects invalid indices.

#include "geometry/mesh/facet_mesh.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace tubefoot {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

constexpr std::int32_t kFar = 1 << 30;

TEST(IsDegenerate, IsExactAtTheEndsOfTheRange) {
  const GridPoint a{-kFar, -kFar, -kFar}, b{0, 0, 0}, c{kFar, kFar, kFar};
  EXPECT_TRUE(is_degenerate(a, b, c));
  EXPECT_TRUE(is_degenerate(a, a, c));
  EXPECT_TRUE(is_degenerate(c, c, c));
  // The point is one unit off a line of 3.7e9 units: an angle of 5e-10 rad, whose cross product cancels
  // 62-bit products.
  EXPECT_FALSE(is_degenerate(a, {0, 0, 1}, c));
  EXPECT_FALSE(is_degenerate({-kFar, -kFar, 0}, {1, 0, 0}, {kFar, kFar - 1, 0}));
}

TEST(IsDegenerate, HoldsForEveryOrderAndEveryAxis) {
  constexpr unsigned kSeed = 7;
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::mt19937 random(kSeed);
  std::uniform_int_distribution<std::int32_t> coordinate(-1000000, 1000000), step(-1000, 1000);
  for (int i = 0; i < 1000; ++i) {
    const GridPoint p{coordinate(random), coordinate(random), coordinate(random)};
    const GridPoint u{step(random), step(random), step(random)};
    const GridPoint q{p.x + 3 * u.x, p.y + 3 * u.y, p.z + 3 * u.z};
    const GridPoint r{p.x - 7 * u.x, p.y - 7 * u.y, p.z - 7 * u.z};
    EXPECT_TRUE(is_degenerate(p, q, r) && is_degenerate(q, r, p) && is_degenerate(r, q, p));
    const GridPoint off{r.x + (u.x == 0), r.y + (u.x != 0 && u.y == 0), r.z + (u.x != 0 && u.y != 0)};
    if (u.x != 0 || u.y != 0 || u.z != 0) {
      EXPECT_FALSE(is_degenerate(p, q, off));
    }
  }
}

TEST(MeshBuilder, WeldsEqualGridPointsAcrossComponents) {
  const WorldGrid grid(10, {0, 0, 0});
  MeshBuilder builder(grid);
  builder.add({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{{0, 1, 2}}}, 3, 0);
  // 0.0001 is a tenth of the unit
  builder.add({{1, 0, 0.0001}, {0, 1, 0}, {1, 1, 0}}, {{{0, 2, 1}}}, 4, 1);
  MeshReport report;
  const FacetMesh mesh = builder.finish(report);
  ASSERT_EQ(mesh.vertices.size(), 4u);
  EXPECT_EQ(mesh.facets, (std::vector<std::array<VertexId, 3>>{{0, 1, 2}, {1, 3, 2}}));
  EXPECT_EQ(mesh.material, (std::vector<std::uint16_t>{3, 4}));
  EXPECT_EQ(mesh.component, (std::vector<std::uint16_t>{0, 1}));
  EXPECT_DOUBLE_EQ(report.largest_snap_m, 0.0001);
  EXPECT_EQ(report.degenerate_facets, 0u);
  EXPECT_EQ(report.duplicate_facets, 0u);
}

TEST(MeshBuilder, KeepsAndCountsDegenerateAndDuplicateFacets) {
  MeshBuilder builder(WorldGrid(0, {0, 0, 0}));
  const Triangles triangles = {{0, 1, 2}, {2, 0, 1}, {1, 0, 2}, {0, 1, 3}, {0, 0, 1}, {0, 3, 4}};
  builder.add({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 0, 0}, {2, 0.3, 0.2}}, triangles, 0, 0);
  MeshReport report;
  const FacetMesh mesh = builder.finish(report);
  EXPECT_EQ(mesh.facets.size(), triangles.size());
  EXPECT_EQ(report.duplicate_facets, 2u);  // {2,0,1} and the reversed {1,0,2}
  EXPECT_EQ(report.degenerate_facets,
            3u);  // collinear, a repeated vertex, and two at one grid point
  EXPECT_EQ(mesh.vertices.size(), 4u);
  EXPECT_NEAR(report.largest_snap_m, std::hypot(0.3, 0.2), 1e-15);
}

TEST(MeshBuilder, IsEmptyAfterFinish) {
  MeshBuilder builder(WorldGrid(0, {0, 0, 0}));
  builder.add({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{{0, 1, 2}}, {{0, 1, 2}}}, 0, 0);
  MeshReport report;
  EXPECT_EQ(builder.finish(report).facets.size(), 2u);
  EXPECT_EQ(report.duplicate_facets, 1u);
  EXPECT_TRUE(builder.finish(report).facets.empty());
  EXPECT_EQ(report.duplicate_facets, 0u);
  builder.add({{5, 0, 0}, {6, 0, 0}, {5, 1, 0}}, {{{0, 1, 2}}}, 0, 0);
  const FacetMesh mesh = builder.finish(report);
  EXPECT_EQ(mesh.vertices.size(), 3u);
  EXPECT_EQ(mesh.facets.front(), (std::array<VertexId, 3>{0, 1, 2}));
}

TEST(MeshBuilder, WeldsALargeRegularGridCompletely) {
  constexpr std::uint32_t n = 300;
  MeshBuilder builder(WorldGrid(8, {0, 0, 0}));
  std::vector<glm::dvec3> points;  // each cell with its own corners, as in an STL
  Triangles triangles;
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = 0; j < n; ++j) {
      const auto first = static_cast<std::uint32_t>(points.size());
      for (const auto& [x, y] : {std::pair{i, j}, {i + 1, j}, {i, j + 1}}) points.emplace_back(x, y, 0);
      triangles.push_back({first, first + 1, first + 2});
    }
  }
  builder.add(points, triangles, 0, 0);
  MeshReport report;
  const FacetMesh mesh = builder.finish(report);
  EXPECT_EQ(mesh.facets.size(), std::size_t{n} * n);
  // the far corner belongs to no triangle
  EXPECT_EQ(mesh.vertices.size(), std::size_t{n + 1} * (n + 1) - 1);
}

TEST(MeshBuilder, RefusesBadIndicesAndPointsBeyondTheGrid) {
  MeshBuilder builder(WorldGrid(20, {0, 0, 0}));
  EXPECT_THROW(builder.add({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{{0, 1, 3}}}, 0, 0), std::out_of_range);
  EXPECT_THROW(builder.add({{0, 0, 0}, {1, 0, 0}, {0, 2000, 0}}, {{{0, 1, 2}}}, 0, 0), GridRangeError);
}

}  // namespace
}  // namespace tubefoot
