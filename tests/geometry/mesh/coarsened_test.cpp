// SPDX-License-Identifier: GPL-3.0-or-later
// Tests coarse meshes: their distance from the original surface, point by point with CGAL's trees, their
// normals, topology and borders.
#include "geometry/mesh/coarsened.hpp"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <map>
#include <random>
#include <set>

#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

using Triangle = std::array<VertexId, 3>;
using Edge = std::array<VertexId, 2>;

glm::dvec3 vector_of(GridPoint p) { return {p.x, p.y, p.z}; }

glm::dvec3 corner(const FacetMesh& mesh, std::size_t facet, std::size_t k) {
  return vector_of(mesh.vertices[mesh.facets[facet][k]]);
}

glm::dvec3 area(const FacetMesh& mesh, std::size_t facet) {
  return 0.5 * glm::cross(corner(mesh, facet, 1) - corner(mesh, facet, 0),
                          corner(mesh, facet, 2) - corner(mesh, facet, 0));
}

/// Makes a mesh of one component and material.
FacetMesh mesh_of(std::vector<GridPoint> vertices, std::vector<Triangle> facets) {
  FacetMesh mesh{std::move(vertices), std::move(facets), {}, {}};
  mesh.material.assign(mesh.facets.size(), 0);
  mesh.component.assign(mesh.facets.size(), 0);
  return mesh;
}

constexpr double cell = 50'000;

/// Makes a grid of cells with a height function in grid units.
FacetMesh terrain(int cells, const std::function<double(double x, double y)>& height) {
  std::vector<GridPoint> vertices;
  std::vector<Triangle> facets;
  for (int i = 0; i <= cells; ++i)
    for (int k = 0; k <= cells; ++k)
      vertices.push_back({int(cell * i), int(cell * k), int(std::lround(height(cell * i, cell * k)))});
  for (int i = 0; i < cells; ++i)
    for (int k = 0; k < cells; ++k) {
      const auto a = VertexId(i * (cells + 1) + k), b = a + VertexId(cells + 1);
      facets.push_back({a, b, a + 1});
      facets.push_back({b, b + 1, a + 1});
    }
  return mesh_of(std::move(vertices), std::move(facets));
}

double waves(double x, double y) { return 400'000 * std::sin(x / 1.1e6) * std::cos(y / 1.7e6 + x / 5e6); }

FacetMesh noisy_terrain(int cells, double noise) {
  std::mt19937 random(7);
  return terrain(cells, [&](double x, double y) {
    return waves(x, y) + std::uniform_real_distribution(-noise, noise)(random);
  });
}

/// Makes a closed mesh about an axis, of `around` times `along` squares. Ends that meet make it a torus.
FacetMesh torus(int around, int along, double radius, double tube) {
  std::vector<GridPoint> vertices;
  std::vector<Triangle> facets;
  for (int i = 0; i < around; ++i)
    for (int k = 0; k < along; ++k) {
      const double u = 2 * pi * i / around, v = 2 * pi * k / along, r = radius + tube * std::cos(v);
      vertices.push_back({int(std::lround(r * std::cos(u))), int(std::lround(r * std::sin(u))),
                          int(std::lround(tube * std::sin(v)))});
    }
  const auto id = [&](int i, int k) { return VertexId((i % around) * along + k % along); };
  for (int i = 0; i < around; ++i)
    for (int k = 0; k < along; ++k) {
      facets.push_back({id(i, k), id(i + 1, k), id(i + 1, k + 1)});
      facets.push_back({id(i, k), id(i + 1, k + 1), id(i, k + 1)});
    }
  return mesh_of(std::move(vertices), std::move(facets));
}

/// Makes an octahedron with each facet cut into n * n, projected onto a sphere.
FacetMesh sphere(int n, double radius) {
  std::map<std::array<int, 3>, VertexId> ids;
  std::vector<GridPoint> vertices;
  std::vector<Triangle> facets;
  const auto id = [&](std::array<int, 3> at) {
    const auto [found, is_new] = ids.try_emplace(at, VertexId(vertices.size()));
    if (is_new) {
      const glm::dvec3 p = radius * glm::normalize(glm::dvec3(at[0], at[1], at[2]));
      vertices.push_back({int(std::lround(p.x)), int(std::lround(p.y)), int(std::lround(p.z))});
    }
    return found->second;
  };
  for (const int x : {-1, 1})
    for (const int y : {-1, 1})
      for (const int z : {-1, 1})
        for (int i = 0; i < n; ++i)
          for (int k = 0; i + k < n; ++k) {
            const auto at = [&](int a, int b) { return id({x * a, y * b, z * (n - a - b)}); };
            const auto add = [&](VertexId a, VertexId b, VertexId c) {
              facets.push_back(x * y * z > 0 ? Triangle{a, b, c} : Triangle{a, c, b});
            };
            add(at(i, k), at(i + 1, k), at(i, k + 1));
            if (i + k + 2 <= n) add(at(i + 1, k), at(i + 1, k + 1), at(i, k + 1));
          }
  return mesh_of(std::move(vertices), std::move(facets));
}

CoarseMesh coarse(const FacetMesh& mesh, double most_move, double most_turn_rad = 0.5) {
  return coarsened(mesh, std::vector<double>(mesh.facets.size(), most_move), most_turn_rad);
}

/// Distances of points to a mesh.
class Distances {
  using Kernel = CGAL::Simple_cartesian<double>;
  using Triangles = std::vector<Kernel::Triangle_3>;
  using Tree =
      CGAL::AABB_tree<CGAL::AABB_traits<Kernel, CGAL::AABB_triangle_primitive<Kernel, Triangles::iterator>>>;

 public:
  explicit Distances(const FacetMesh& mesh) {
    const auto point = [&](std::size_t f, std::size_t k) {
      const glm::dvec3 p = corner(mesh, f, k);
      return Kernel::Point_3(p.x, p.y, p.z);
    };
    for (std::size_t f = 0; f < mesh.facets.size(); ++f)
      triangles_.emplace_back(point(f, 0), point(f, 1), point(f, 2));
    tree_.insert(triangles_.begin(), triangles_.end());
    tree_.build();
  }
  double of(const glm::dvec3& p) const {
    return std::sqrt(tree_.squared_distance(Kernel::Point_3(p.x, p.y, p.z)));
  }

 private:
  Triangles triangles_;
  Tree tree_;
};

glm::dvec3 drawn_point(const FacetMesh& mesh, std::size_t facet, std::mt19937& random) {
  std::uniform_real_distribution<double> draw(0, 1);
  double u = draw(random), v = draw(random);
  if (u + v > 1) u = 1 - u, v = 1 - v;
  return corner(mesh, facet, 0) + u * (corner(mesh, facet, 1) - corner(mesh, facet, 0)) +
         v * (corner(mesh, facet, 2) - corner(mesh, facet, 0));
}

/// Expects that distances of random points in both directions are within the bounds. Returns the largest
/// ratio of distance to bound.
double expect_near(const FacetMesh& given, const CoarseMesh& made, double most_move) {
  std::mt19937 random(11);
  const Distances to_given(given), to_made(made.mesh);
  double largest = 0;
  for (std::size_t f = 0; f < made.mesh.facets.size(); ++f) {
    EXPECT_LE(made.move[f], most_move);
    for (int draw = 0; draw < 12; ++draw) {
      const double distance = to_given.of(drawn_point(made.mesh, f, random));
      EXPECT_LE(distance, made.move[f] + 1e-3) << "facet " << f;
      largest = std::max(largest, distance);
    }
  }
  for (std::size_t f = 0; f < given.facets.size(); ++f) {
    const double distance = to_made.of(drawn_point(given, f, random));
    EXPECT_LE(distance, most_move);
    largest = std::max(largest, distance);
  }
  return largest / *std::ranges::max_element(made.move);
}

std::set<Edge> edges_of(const FacetMesh& mesh) {
  std::set<Edge> edges;
  for (const Triangle& t : mesh.facets)
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_TRUE(edges.insert({t[k], t[(k + 1) % 3]}).second) << "a sheet crosses an edge twice";
  return edges;
}

std::set<Edge> border_of(const FacetMesh& mesh) {
  const std::set<Edge> edges = edges_of(mesh);
  std::set<Edge> border;
  for (const auto& [a, b] : edges)
    if (!edges.contains({b, a})) border.insert({a, b});
  return border;
}

/// Vertices minus edges plus facets.
long characteristic(const FacetMesh& mesh) {
  std::set<VertexId> used;
  for (const Triangle& t : mesh.facets) used.insert(t.begin(), t.end());
  return long(used.size()) - long(edges_of(mesh).size() / 2) + long(mesh.facets.size());
}

double volume(const FacetMesh& mesh) {
  double sum = 0;
  for (std::size_t f = 0; f < mesh.facets.size(); ++f) sum += glm::dot(area(mesh, f), corner(mesh, f, 0)) / 3;
  return sum;
}

// Law N4 for terrain: facets move vertically, and errors do not accumulate.
TEST(Coarsened, TerrainIsAsNearAsIsReported) {
  for (const double most_move : {1'000.0, 10'000.0, 40'000.0}) {
    const FacetMesh smooth = terrain(80, waves), rough = noisy_terrain(80, 5'000);
    for (const FacetMesh* given : {&smooth, &rough}) {
      const CoarseMesh made = coarse(*given, most_move);
      EXPECT_GT(expect_near(*given, made, most_move), 0.5);  // the bound is not far too large
      EXPECT_LE(made.largest_share, 1);
      if (given == &smooth) {
        EXPECT_LT(5 * made.mesh.facets.size(), given->facets.size());
      }
    }
  }
}

// Law N4 for surfaces with all orientations.
TEST(Coarsened, RoundThingsAreAsNearAsIsReported) {
  for (const FacetMesh& given : {sphere(40, 2e6), torus(160, 60, 4e6, 1.5e6)})
    for (const double most_move : {3'000.0, 30'000.0}) {
      const CoarseMesh made = coarse(given, most_move);
      EXPECT_GT(expect_near(given, made, most_move), 0.3);
      EXPECT_LT((most_move < 10'000 ? 1 : 5) * made.mesh.facets.size(), given.facets.size() * 9 / 10);
    }
}

// Law N4: for terrain the map is vertical, so that the test can compare normals.
TEST(Coarsened, NormalsTurnByNoMoreThanIsReported) {
  const FacetMesh given = noisy_terrain(60, 4'000);
  constexpr double most_turn_rad = 0.25;
  const CoarseMesh made = coarse(given, 20'000, most_turn_rad);
  EXPECT_LT(2 * made.mesh.facets.size(), given.facets.size());
  std::mt19937 random(5);
  double largest = 0, told = 0;
  for (std::size_t f = 0; f < made.mesh.facets.size(); ++f) {
    EXPECT_LE(made.turn_rad[f], most_turn_rad + 1e-6);
    told = std::max(told, made.turn_rad[f]);
    for (int draw = 0; draw < 40; ++draw) {
      const glm::dvec3 at = drawn_point(made.mesh, f, random);
      const int i = std::clamp(int(at.x / cell), 0, 59), k = std::clamp(int(at.y / cell), 0, 59);
      const bool upper = at.x / cell - i + at.y / cell - k > 1;
      const auto there = std::size_t(2 * (i * 60 + k) + (upper ? 1 : 0));
      const glm::dvec3 n = glm::normalize(area(given, there)), m = glm::normalize(area(made.mesh, f));
      const double height =
          corner(given, there, 0).z -
          (n.x * (at.x - corner(given, there, 0).x) + n.y * (at.y - corner(given, there, 0).y)) / n.z;
      const double turn_rad = std::acos(std::min(1.0, glm::dot(n, m)));
      EXPECT_LE(turn_rad, made.turn_rad[f] + 1e-6);
      EXPECT_LE(std::abs(height - at.z), made.move[f] + 1e-3);
      largest = std::max(largest, turn_rad);
    }
  }
  EXPECT_GT(largest, 0.5 * told);
}

// Law N5.
TEST(Coarsened, WhatIsClosedStaysClosed) {
  for (const double most_move : {2'000.0, 50'000.0, 600'000.0}) {
    SCOPED_TRACE(most_move);
    const FacetMesh ball = sphere(24, 2e6), ring = torus(90, 40, 4e6, 1.5e6);
    for (const FacetMesh* given : {&ball, &ring}) {
      const CoarseMesh made = coarse(*given, most_move, 1.5);
      EXPECT_TRUE(border_of(made.mesh).empty());
      EXPECT_EQ(characteristic(made.mesh), given == &ball ? 2 : 0);
      double all = 0;
      for (std::size_t f = 0; f < given->facets.size(); ++f) all += glm::length(area(*given, f));
      EXPECT_NEAR(volume(made.mesh), volume(*given), most_move * all);
      EXPECT_GT(volume(made.mesh), 0);
    }
  }
}

// Law N5: no vertex of a tetrahedron can be removed, for any permitted displacement.
TEST(Coarsened, NothingFolds) {
  const FacetMesh four = mesh_of({{0, 0, 0}, {900, 0, 0}, {0, 900, 0}, {0, 0, 900}},
                                 {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}});
  EXPECT_EQ(coarse(four, 1e9, 3).mesh.facets, four.facets);
  const CoarseMesh made = coarse(sphere(16, 1e6), 1e9, 1.0);
  EXPECT_TRUE(border_of(made.mesh).empty());
  EXPECT_EQ(characteristic(made.mesh), 2);
}

// Law N5: borders of surfaces, of components and of materials.
TEST(Coarsened, BordersStay) {
  FacetMesh seabed = terrain(60, waves);
  for (std::size_t f = 0; f < seabed.facets.size(); ++f) {
    const glm::dvec3 at = corner(seabed, f, 0);
    seabed.material[f] = at.x > 1e6 ? 1 : 0;
    seabed.component[f] = at.y > 2e6 ? 1 : 0;
  }
  const CoarseMesh made = coarse(seabed, 30'000);
  EXPECT_LT(5 * made.mesh.facets.size(), seabed.facets.size());
  EXPECT_EQ(border_of(made.mesh), border_of(seabed));
  for (std::uint16_t material = 0; material < 2; ++material)
    for (std::uint16_t component = 0; component < 2; ++component) {
      const auto part = [&](const FacetMesh& mesh) {
        FacetMesh one;
        for (std::size_t f = 0; f < mesh.facets.size(); ++f)
          if (mesh.material[f] == material && mesh.component[f] == component)
            one.facets.push_back(mesh.facets[f]);
        return border_of(one);
      };
      EXPECT_EQ(part(made.mesh), part(seabed));
    }
}

TEST(Coarsened, MoreIsTakenAwayWhereMoreMayMove) {
  const FacetMesh seabed = noisy_terrain(60, 2'000), ball = sphere(30, 2e6);
  for (const FacetMesh* given : {&seabed, &ball}) {
    std::size_t before = given->facets.size();
    for (const double most_move : {500.0, 2'000.0, 8'000.0, 32'000.0, 128'000.0}) {
      const std::size_t after = coarse(*given, most_move).mesh.facets.size();
      EXPECT_LE(after, before) << most_move;
      before = after;
    }
    EXPECT_LT(10 * before, given->facets.size());
  }
}

TEST(Coarsened, LimitsAreThoseOfEachFacet) {
  const FacetMesh seabed = terrain(60, waves);
  std::vector<double> limits(seabed.facets.size());  // in stripes
  for (std::size_t f = 0; f < seabed.facets.size(); ++f) {
    const double x = corner(seabed, f, 0).x;
    limits[f] = x < 10 * cell ? 0 : std::fmod(x, 8 * cell) < 4 * cell ? 60'000 : 1'500;
  }
  const CoarseMesh made = coarsened(seabed, limits, 0.5);
  EXPECT_LT(made.mesh.facets.size(), seabed.facets.size() / 2);
  const std::set<Triangle> there(made.mesh.facets.begin(), made.mesh.facets.end());
  std::mt19937 random(3);
  const Distances to_made(made.mesh);
  for (std::size_t f = 0; f < seabed.facets.size(); ++f) {
    EXPECT_TRUE(limits[f] > 0 || there.contains(seabed.facets[f])) << f;
    for (int draw = 0; draw < 5; ++draw)
      EXPECT_LE(to_made.of(drawn_point(seabed, f, random)), limits[f] + 1e-3) << f;
  }
}

TEST(Coarsened, NothingMovesWhereNothingMay) {
  for (const FacetMesh& given : {noisy_terrain(20, 2'000), terrain(20, [](double, double) { return 0.0; })}) {
    const CoarseMesh made = coarse(given, 0);
    EXPECT_EQ(made.mesh.vertices, given.vertices);
    EXPECT_EQ(made.mesh.facets, given.facets);
    EXPECT_EQ(*std::ranges::max_element(made.move), 0);
    EXPECT_EQ(*std::ranges::max_element(made.turn_rad), 0);
  }
  EXPECT_TRUE(coarse({}, 1).mesh.facets.empty());
}

TEST(Coarsened, IsTheSameEachTime) {
  const FacetMesh given = noisy_terrain(50, 3'000);
  const CoarseMesh one = coarse(given, 10'000), two = coarse(given, 10'000);
  EXPECT_EQ(one.mesh.facets, two.mesh.facets);
  EXPECT_EQ(one.move, two.move);
  EXPECT_EQ(one.turn_rad, two.turn_rad);
}

// The vertices of these cases stay: three surfaces at an edge, the tip of a cone on a surface, duplicate
// facets, and facets without area.
TEST(Coarsened, WhatIsNoSheetKeepsItsCorners) {
  FacetMesh seabed = terrain(20, waves);
  const auto add = [&](VertexId a, VertexId b, VertexId c) {
    seabed.facets.push_back({a, b, c}), seabed.material.push_back(0), seabed.component.push_back(0);
  };
  const auto at = [](int i, int k) { return VertexId(21 * i + k); };
  const auto high = VertexId(seabed.vertices.size());
  seabed.vertices.push_back({int(10 * cell), int(10 * cell), 3'000'000});
  seabed.vertices.push_back({int(11 * cell), int(10 * cell), 3'000'000});
  add(at(5, 5), at(6, 5), high);         // a third surface
  add(at(12, 12), high, high + 1);       // its tip lies on the seabed
  add(at(8, 3), at(9, 3), at(8, 4));     // duplicate facet
  add(at(15, 3), at(15, 3), at(15, 4));  // no area
  const CoarseMesh made = coarse(seabed, 50'000);
  EXPECT_LT(made.mesh.facets.size(), seabed.facets.size() / 2);
  std::multiset<Triangle> there(made.mesh.facets.begin(), made.mesh.facets.end());
  std::set<VertexId> used;
  for (const Triangle& t : made.mesh.facets) used.insert(t.begin(), t.end());
  for (std::size_t f = seabed.facets.size() - 4; f < seabed.facets.size(); ++f) {
    for (const VertexId v : seabed.facets[f]) EXPECT_TRUE(used.contains(v));
    EXPECT_TRUE(there.contains(seabed.facets[f]));
  }
}

}  // namespace
}  // namespace tubefoot
