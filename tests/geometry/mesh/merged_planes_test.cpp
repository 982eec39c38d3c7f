// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the merging of coplanar facets: planes in any position, with holes, steps and borders between
// materials.
#include "geometry/mesh/merged_planes.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>

#include "geometry/mesh/facet_cone.hpp"

namespace tubefoot {
namespace {

using Triangle = std::array<VertexId, 3>;

GridPoint operator+(GridPoint a, GridPoint b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
GridPoint operator*(std::int32_t k, GridPoint a) { return {k * a.x, k * a.y, k * a.z}; }

/// All coordinates are multiples of this prime, so that middle_of() is a grid point. The prime is so large
/// that these points lie on no line between vertices within a few cells.
constexpr std::int32_t prime = 10007;

/// Facets between arbitrary points, with merged vertices.
class Patchwork {
 public:
  explicit Patchwork(std::int32_t scale = prime) : scale_(scale) {}
  void add(GridPoint a, GridPoint b, GridPoint c, std::uint16_t material = 0, std::uint16_t component = 0) {
    mesh.facets.push_back({id(a), id(b), id(c)});
    mesh.material.push_back(material);
    mesh.component.push_back(component);
  }
  /// Adds a parallelogram at `at` of sides u and v, cut along either diagonal. It faces along u x v.
  void cell(GridPoint at, GridPoint u, GridPoint v, bool diagonal = false, std::uint16_t material = 0,
            std::uint16_t component = 0) {
    const GridPoint corners[] = {at, at + u, at + u + v, at + v};
    const unsigned turn = diagonal ? 1 : 0;
    const auto corner = [&](unsigned k) { return corners[(k + turn) % 4]; };
    add(corner(0), corner(1), corner(2), material, component);
    add(corner(0), corner(2), corner(3), material, component);
  }
  void plane(GridPoint at, GridPoint u, GridPoint v, int columns, int rows) {
    for (int i = 0; i < columns; ++i)
      for (int k = 0; k < rows; ++k) cell(at + i * u + k * v, u, v, (i + k) % 3 == 0);
  }
  FacetMesh mesh;

 private:
  VertexId id(GridPoint at) {
    const GridPoint p = scale_ * at;
    const auto [found, is_new] = ids_.try_emplace(p, static_cast<VertexId>(mesh.vertices.size()));
    if (is_new) mesh.vertices.push_back(p);
    return found->second;
  }
  std::int32_t scale_;
  std::map<GridPoint, VertexId> ids_;
};

bool same(const FacetMesh& a, const FacetMesh& b) {
  return a.vertices == b.vertices && a.facets == b.facets && a.material == b.material &&
         a.component == b.component;
}

Vec64 normal(const FacetMesh& mesh, const Triangle& t) {
  return cross(mesh.vertices[t[1]] - mesh.vertices[t[0]], mesh.vertices[t[2]] - mesh.vertices[t[0]]);
}

/// Sign of det(a, b, c) for three directions, in plain 128-bit integers: the numbers of the tests are
/// small.
int turn(const Vec64& n, const GridPoint& a, const GridPoint& b) {
  const Vec64 c = cross(a, b);
  return sign(Int128(n.x) * c.x + Int128(n.y) * c.y + Int128(n.z) * c.z);
}

/// Returns whether a point in the plane of a triangle lies strictly inside it.
bool is_inside(const FacetMesh& mesh, const Triangle& t, GridPoint p) {
  const Vec64 n = normal(mesh, t);
  for (unsigned k = 0; k < 3; ++k)
    if (turn(n, mesh.vertices[t[(k + 1) % 3]] - mesh.vertices[t[k]], p - mesh.vertices[t[k]]) <= 0)
      return false;
  return dot(n, p) == dot(n, mesh.vertices[t[0]]);
}

/// Twice the area vector. For facets of one plane and one orientation it is twice their area.
std::array<Int128, 3> area(const FacetMesh& mesh) {
  std::array<Int128, 3> sum{};
  for (const Triangle& t : mesh.facets) {
    const Vec64 n = normal(mesh, t);
    sum[0] += n.x, sum[1] += n.y, sum[2] += n.z;
  }
  return sum;
}

/// Number of vertices that lie inside an edge of another facet.
std::size_t t_junctions(const FacetMesh& mesh) {
  std::set<VertexId> used;
  for (const Triangle& t : mesh.facets) used.insert(t.begin(), t.end());
  std::size_t count = 0;
  for (const Triangle& t : mesh.facets)
    for (unsigned k = 0; k < 3; ++k) {
      const GridPoint a = mesh.vertices[t[k]], b = mesh.vertices[t[(k + 1) % 3]];
      for (const VertexId v : used) {
        const GridPoint p = mesh.vertices[v], u = p - a, w = b - p;
        const Vec64 n = cross(u, w);
        if (n.x == 0 && n.y == 0 && n.z == 0 && Int128(u.x) * w.x + Int128(u.y) * w.y + Int128(u.z) * w.z > 0)
          ++count;
      }
    }
  return count;
}

/// A point inside a facet, for coordinates that are multiples of the prime.
GridPoint middle_of(const FacetMesh& mesh, const Triangle& t) {
  constexpr std::int32_t weights[] = {5003, 3119, prime - 5003 - 3119};
  GridPoint middle;
  for (unsigned k = 0; k < 3; ++k) {
    const GridPoint p = mesh.vertices[t[k]];
    middle = middle + weights[k] * GridPoint{p.x / prime, p.y / prime, p.z / prime};
  }
  return middle;
}

/// Compares point by point and by area.
void expect_same_surface(const FacetMesh& before, const FacetMesh& after) {
  EXPECT_EQ(before.vertices, after.vertices);
  EXPECT_EQ(after.facets.size(), after.material.size());
  EXPECT_EQ(after.facets.size(), after.component.size());
  EXPECT_TRUE(area(before) == area(after));
  EXPECT_TRUE(std::ranges::is_sorted(after.component));
  for (std::size_t f = 0; f < before.facets.size(); ++f) {
    const Triangle& facet = before.facets[f];
    const GridPoint p = middle_of(before, facet);
    std::size_t covers = 0;
    for (std::size_t k = 0; k < after.facets.size(); ++k) {
      const Vec64 n = normal(after, after.facets[k]), m = normal(before, facet);
      if (!is_inside(after, after.facets[k], p)) continue;
      if (after.material[k] != before.material[f] || after.component[k] != before.component[f]) continue;
      if (Int128(n.x) * m.x + Int128(n.y) * m.y + Int128(n.z) * m.z > 0) ++covers;
    }
    EXPECT_EQ(covers, 1u) << "facet " << f;
  }
}

FacetMesh merged_or_same(const FacetMesh& mesh) { return with_planes_merged(mesh).value_or(mesh); }

// Laws N1 and N2.
TEST(MergedPlanes, APlaneIsTwoFacets) {
  Patchwork seabed;
  seabed.plane({-300, 30, 9}, {30, 0, 0}, {0, 30, 0}, 20, 15);
  const FacetMesh merged = merged_or_same(seabed.mesh);
  EXPECT_EQ(merged.facets.size(), 2u);
  EXPECT_EQ(t_junctions(merged), 0u);
  expect_same_surface(seabed.mesh, merged);
}

TEST(MergedPlanes, ABoxStaysClosed) {
  Patchwork box;
  constexpr int n = 6;
  const GridPoint x{21, 3, 0}, y{-3, 21, 6}, z{0, -6, 24};
  box.plane({0, 0, 0}, y, x, n, n);
  box.plane(n * z, x, y, n, n);
  box.plane({0, 0, 0}, x, z, n, n);
  box.plane(n * y, z, x, n, n);
  box.plane({0, 0, 0}, z, y, n, n);
  box.plane(n * x, y, z, n, n);
  const FacetMesh merged = merged_or_same(box.mesh);
  EXPECT_EQ(merged.facets.size(), 12u);
  std::set<std::array<VertexId, 2>> edges;
  for (const Triangle& t : merged.facets)
    for (unsigned k = 0; k < 3; ++k) EXPECT_TRUE(edges.insert({t[k], t[(k + 1) % 3]}).second);
  for (const auto& [a, b] : edges) EXPECT_TRUE(edges.contains({b, a}));
  expect_same_surface(box.mesh, merged);
}

// Only the border of unmerged facets determines how coarse adjacent facets may be.
TEST(MergedPlanes, ABorderToFineFacetsKeepsItsVertices) {
  Patchwork seabed;
  seabed.plane({0, 0, 0}, {30, 0, 0}, {0, 30, 0}, 8, 8);
  std::mt19937 random(3);
  for (int i = 0; i < 8; ++i) {
    const std::int32_t up = 3 * std::uniform_int_distribution(1, 9)(random);
    seabed.add({30 * i, 240, 0}, {30 * (i + 1), 240, 0}, {30 * i + 15, 270, up});
  }
  const FacetMesh merged = merged_or_same(seabed.mesh);
  EXPECT_LT(merged.facets.size(), 8u + 12u);
  EXPECT_EQ(t_junctions(merged), 0u);
  expect_same_surface(seabed.mesh, merged);
}

TEST(MergedPlanes, StripesOfMaterialsStayApart) {
  Patchwork seabed;
  for (int i = 0; i < 12; ++i)
    for (int k = 0; k < 12; ++k)
      seabed.cell({30 * i, 30 * k, 0}, {30, 0, 0}, {0, 30, 0}, false, i / 4 == 1 ? 1 : 0);
  const FacetMesh merged = merged_or_same(seabed.mesh);
  EXPECT_EQ(merged.facets.size(), 6u);
  EXPECT_EQ(t_junctions(merged), 0u);
  expect_same_surface(seabed.mesh, merged);
}

TEST(MergedPlanes, WhatFacesTheOtherWayIsAnotherPlane) {
  Patchwork sheet;
  sheet.plane({0, 0, 0}, {30, 0, 0}, {0, 30, 0}, 6, 6);
  sheet.plane({0, 0, 0}, {0, 30, 0}, {30, 0, 0}, 6, 6);
  const FacetMesh merged = merged_or_same(sheet.mesh);
  EXPECT_EQ(merged.facets.size(), 4u);
  expect_same_surface(sheet.mesh, merged);
}

TEST(MergedPlanes, WhatOverlapsOrIsRoughStaysAsItIs) {
  Patchwork twice;
  twice.plane({0, 0, 0}, {30, 0, 0}, {0, 30, 0}, 6, 6);
  twice.plane({15, 15, 0}, {30, 0, 0}, {0, 30, 0}, 6, 6);
  EXPECT_FALSE(with_planes_merged(twice.mesh));

  // A fan of one and a half turns about its middle covers parts of its plane twice, although no two edges
  // are equal.
  Patchwork fan;
  const GridPoint rim[] = {{90, 0, 0},    {60, 60, 0},  {0, 90, 0},   {-60, 60, 0}, {-90, 0, 0},
                           {-60, -60, 0}, {0, -90, 0},  {60, -60, 0}, {120, 0, 0},  {90, 90, 0},
                           {0, 120, 0},   {-90, 90, 0}, {-120, 0, 0}};
  for (std::size_t k = 0; k + 1 < std::size(rim); ++k) fan.add({0, 0, 0}, rim[k], rim[k + 1]);
  EXPECT_FALSE(with_planes_merged(fan.mesh));

  Patchwork rough;
  std::mt19937 random(5);
  std::map<std::pair<int, int>, GridPoint> at;
  for (int i = 0; i <= 20; ++i)
    for (int k = 0; k <= 20; ++k)
      at[{i, k}] = {30 * i, 30 * k, std::uniform_int_distribution(-20, 20)(random)};
  for (int i = 0; i < 20; ++i)
    for (int k = 0; k < 20; ++k) {
      rough.add(at[{i, k}], at[{i + 1, k}], at[{i + 1, k + 1}]);
      rough.add(at[{i, k}], at[{i + 1, k + 1}], at[{i, k + 1}]);
    }
  rough.add({0, 0, 0}, {0, 0, 0}, {30, 0, 5});  // no area
  EXPECT_FALSE(with_planes_merged(rough.mesh));
  EXPECT_FALSE(with_planes_merged({}));
}

TEST(MergedPlanes, FarFromTheOriginPlanesAreReported) {
  constexpr std::int32_t far = (1 << 30) - 3000;
  Patchwork seabed(1);
  seabed.plane({far, -far, far}, {30, 0, 1}, {0, 30, -2}, 9, 9);
  seabed.plane({far, -far, far - 1}, {30, 0, 1}, {0, 30, -2}, 9, 9);  // a unit below it
  const FacetMesh merged = merged_or_same(seabed.mesh);
  EXPECT_EQ(merged.facets.size(), 4u);
  EXPECT_TRUE(area(seabed.mesh) == area(merged));
}

/// Cells of a tilted lattice with some gaps, in two materials and two components.
FacetMesh random_cells(std::mt19937& random, std::size_t& cells) {
  const auto number = [&](int lo, int hi) { return std::uniform_int_distribution(lo, hi)(random); };
  Patchwork some;
  const GridPoint u{3 * number(1, 9), 3 * number(-4, 4), 3 * number(-9, 9)},
      v{3 * number(-4, 4), 3 * number(5, 9), 3 * number(-9, 9)};
  const int holes = number(0, 30), size = number(4, 12);
  const bool striped = number(0, 1) == 1;
  for (std::uint16_t component = 0; component < 2; ++component)
    for (int i = 0; i < size; ++i)
      for (int k = 0; k < size; ++k) {
        if (number(0, 99) < holes) continue;
        some.cell((i + component * size) * u + k * v, u, v, number(0, 1) == 1,
                  striped && k < size / 2 ? 1 : 0, component);
      }
  cells = some.mesh.facets.size() / 2;
  return some.mesh;
}

// Laws N1 to N3.
TEST(MergedPlanes, OfRandomCellsAreTheSameSurface) {
  std::size_t gained = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    std::size_t cells = 0;
    const FacetMesh mesh = random_cells(random, cells);
    const FacetMesh merged = merged_or_same(mesh);
    expect_same_surface(mesh, merged);
    EXPECT_EQ(t_junctions(merged), 0u);
    EXPECT_LE(merged.facets.size(), mesh.facets.size());
    if (2 * merged.facets.size() <= mesh.facets.size()) ++gained;
    const tbb::global_control alone(tbb::global_control::max_allowed_parallelism, 1);
    EXPECT_TRUE(same(merged, merged_or_same(mesh)));
  }
  EXPECT_GT(gained, 20u);
}

}  // namespace
}  // namespace tubefoot
