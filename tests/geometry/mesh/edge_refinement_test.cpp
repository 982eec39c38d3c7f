// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the refinement of meshes by bisection of edges. Parts fill their facets exactly, closed meshes stay
// closed, and local refinement equals uniform refinement where it is needed.

#include "geometry/mesh/edge_refinement.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <functional>
#include <glm/geometric.hpp>
#include <map>
#include <numeric>
#include <set>

#include "fixtures/geometry/grid_scenes.hpp"

namespace tubefoot {
namespace {

using namespace test;

const WorldGrid grid(10, {3, -5, 1});  // about 1 mm

/// Cuts edges that are longer than a function of the midpoint of the edge.
struct SizeRule : EdgeRule {
  using Size = std::function<double(glm::dvec3 middle, double length)>;
  explicit SizeRule(Size s) : size(std::move(s)) {}
  bool cuts(const BasePoint& a, const BasePoint& b) const override {
    const double length = glm::distance(a.at_m, b.at_m);
    return length > size(0.5 * (a.at_m + b.at_m), length);
  }
  Size size;
};

SizeRule uniform_rule(double h) {
  return SizeRule([h](glm::dvec3, double) { return h; });
}

/// Sizes that change by factors at the borders of a few spheres.
SizeRule rough_rule(std::uint64_t seed, double finest) {
  struct Ball {
    glm::dvec3 centre;
    double radius, size;
  };
  std::vector<Ball> balls;
  Random random(seed);
  const auto at = [&](double lo, double hi) {
    return std::uniform_real_distribution<double>(lo, hi)(random);
  };
  for (int k = 0; k < 6; ++k)
    balls.push_back({grid.to_metres({}) + glm::dvec3{at(-5, 5), at(-5, 5), at(-5, 5)}, at(0, 3),
                     finest * std::exp2(uniform(random, 0, 4))});
  return SizeRule([balls](glm::dvec3 middle, double length) {
    double size = 8;
    for (const Ball& b : balls)
      if (glm::distance(middle, b.centre) < b.radius + 2 * length) size = std::min(size, b.size);
    return size;
  });
}

const PlaceOfPoint stay = [](const BasePoint& p) { return p.at_m; };

std::vector<FacetId> all_of(const FacetMesh& mesh) {
  std::vector<FacetId> all(mesh.facets.size());
  std::iota(all.begin(), all.end(), 0u);
  return all;
}

/// Vertices at multiples of 2^8 units: eight bisections stay on the grid, and `stay` moves nothing.
GridPoint coarse(GridPoint p) { return {p.x / 256 * 256, p.y / 256 * 256, p.z / 256 * 256}; }

/// Random triangles in which many facets share edges, some with three or more facets.
FacetMesh knotted_random_triangles(std::uint64_t seed) {
  Random random(seed);
  FacetMesh mesh;
  for (int v = 0; v < 9; ++v)
    add_vertex(mesh, coarse({uniform(random, -9000, 9000), uniform(random, -9000, 9000),
                             uniform(random, -9000, 9000)}));
  for (int f = 0; f < 25; ++f) {
    std::array<VertexId, 3> v{};
    do
      for (VertexId& id : v) id = static_cast<VertexId>(uniform(random, 0, 8));
    while (v[0] == v[1] || v[1] == v[2] || v[2] == v[0] ||
           is_degenerate(mesh.vertices[v[0]], mesh.vertices[v[1]], mesh.vertices[v[2]]));
    add_facet(mesh, v[0], v[1], v[2]);
    mesh.material.back() = static_cast<std::uint16_t>(f % 3);
    mesh.component.back() = static_cast<std::uint16_t>(f % 2);
  }
  return mesh;
}

FacetMesh octahedron(std::int32_t r) {
  FacetMesh mesh;
  for (const GridPoint p : {GridPoint{r, 0, 0}, {-r, 0, 0}, {0, r, 0}, {0, -r, 0}, {0, 0, r}, {0, 0, -r}})
    add_vertex(mesh, p);
  for (VertexId top : {4u, 5u})
    for (const auto& [a, b] : {std::pair{0u, 2u}, {2u, 1u}, {1u, 3u}, {3u, 0u}})
      top == 4 ? add_facet(mesh, a, b, top) : add_facet(mesh, b, a, top);
  return mesh;
}

using VertexPair = std::pair<VertexId, VertexId>;
std::map<VertexPair, int> facets_by_edge(const FacetMesh& mesh) {
  std::map<VertexPair, int> count;
  for (const auto& f : mesh.facets)
    for (int k = 0; k < 3; ++k) ++count[std::minmax(f[k], f[(k + 1) % 3])];
  return count;
}

bool on_segment(GridPoint p, GridPoint a, GridPoint b) {
  return is_degenerate(p, a, b) && std::min(a, b) <= p && p <= std::max(a, b);
}

std::array<std::int64_t, 3> doubled_area(const FacetMesh& mesh, const std::array<VertexId, 3>& f) {
  const auto difference = [&](VertexId v, VertexId w) {
    const GridPoint p = mesh.vertices[v], q = mesh.vertices[w];
    return std::array<std::int64_t, 3>{p.x - q.x, p.y - q.y, p.z - q.z};
  };
  const auto u = difference(f[1], f[0]), v = difference(f[2], f[0]);
  return {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
}

/// In a mesh without T-junctions, each part of a base edge belongs to as many facets as the base edge. Each
/// other edge belongs to two. A vertex inside an edge would end other edges there.
// Law D1.
TEST(EdgeRefinement, FacetsThatShareAnEdgeShareItsParts) {
  std::size_t shared_by_three = 0;
  for (std::uint64_t seed = 1; seed <= 20 / one_in + 1; ++seed) {
    SCOPED_TRACE(seed);
    const FacetMesh base = knotted_random_triangles(seed);
    const std::map<VertexPair, int> base_edges = facets_by_edge(base);
    for (FacetId f = 0; f < base.facets.size(); ++f) {
      // Takes one facet with all facets that share an edge with it. Facets that only intersect may share
      // points of the grid by chance.
      std::vector<FacetId> ring;
      for (FacetId g = 0; g < base.facets.size(); ++g) {
        int common = 0;
        for (const VertexId v : base.facets[g])
          common += static_cast<int>(std::count(base.facets[f].begin(), base.facets[f].end(), v));
        if (common >= 2) ring.push_back(g);
      }
      const RefinedMesh refined = refine(base, ring, grid, rough_rule(seed, 0.4), stay);
      ASSERT_GT(refined.mesh.facets.size(), ring.size());
      for (int k = 0; k < 3; ++k) {
        const VertexId a = base.facets[f][k], b = base.facets[f][(k + 1) % 3];
        const int wanted = base_edges.at(std::minmax(a, b));
        shared_by_three += wanted >= 3;
        std::map<VertexPair, std::set<FacetId>> parents;
        for (std::size_t s = 0; s < refined.mesh.facets.size(); ++s)
          for (int e = 0; e < 3; ++e) {
            const VertexId p = refined.mesh.facets[s][e], q = refined.mesh.facets[s][(e + 1) % 3];
            if (on_segment(refined.mesh.vertices[p], base.vertices[a], base.vertices[b]) &&
                on_segment(refined.mesh.vertices[q], base.vertices[a], base.vertices[b]))
              parents[std::minmax(p, q)].insert(refined.parent[s]);
          }
        ASSERT_FALSE(parents.empty());
        for (const auto& [edge, facets] : parents) {
          int with_base_edge = 0;
          for (const FacetId g : facets)
            for (int e = 0; e < 3; ++e)
              with_base_edge +=
                  std::minmax(base.facets[g][e], base.facets[g][(e + 1) % 3]) == std::minmax(a, b);
          EXPECT_EQ(with_base_edge, wanted);
        }
      }
    }
  }
  EXPECT_GT(shared_by_three, 50u / one_in);
}

// Law D2.
TEST(EdgeRefinement, PartsOfAFacetFillItExactly) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    const FacetMesh base = knotted_random_triangles(seed);
    const RefinedMesh refined = refine(base, all_of(base), grid, rough_rule(seed, 0.4), stay);
    std::vector<std::array<std::int64_t, 3>> area(base.facets.size());
    for (std::size_t s = 0; s < refined.mesh.facets.size(); ++s) {
      const FacetId f = refined.parent[s];
      const auto part = doubled_area(refined.mesh, refined.mesh.facets[s]);
      const auto whole = doubled_area(base, base.facets[f]);
      double turn = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        area[f][k] += part[k];
        turn += static_cast<double>(part[k]) * static_cast<double>(whole[k]);
      }
      EXPECT_GT(turn, 0) << "a part is turned over or has no area";
      EXPECT_EQ(refined.mesh.material[s], base.material[f]);
      EXPECT_EQ(refined.mesh.component[s], base.component[f]);
    }
    for (FacetId f = 0; f < base.facets.size(); ++f)
      EXPECT_EQ(area[f], doubled_area(base, base.facets[f])) << f;
  }
}

/// OpenMesh is the oracle, because it rejects meshes that are not manifold.
// Law D1.
TEST(EdgeRefinement, AClosedMeshStaysClosedWhereverItsPointsGo) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    const FacetMesh base = octahedron(4096);
    // The random displacement is a function of the base edge or facet that contains the point, as in real
    // displacements.
    const PlaceOfPoint shake = [&](const BasePoint& p) {
      std::vector<std::pair<VertexId, double>> tag;
      for (std::size_t k = 0; k < 3; ++k)
        if (p.weight[k] > 0) tag.emplace_back(base.facets[p.facet][k], p.weight[k]);
      std::sort(tag.begin(), tag.end());
      double phase = tag.size() == 3 ? 0.1 * p.facet : 0;
      for (const auto& [v, w] : tag) phase += (v + 1) * w;
      return p.at_m + 0.02 * glm::dvec3{std::sin(40 * phase), std::cos(70 * phase), std::sin(90 * phase)};
    };
    const RefinedMesh refined = refine(base, all_of(base), grid, rough_rule(seed, 0.1), shake);
    OpenMesh::TriMesh_ArrayKernelT<> mesh;
    std::vector<OpenMesh::VertexHandle> handle;
    for (std::size_t v = 0; v < refined.mesh.vertices.size(); ++v) handle.push_back(mesh.add_vertex({}));
    for (const auto& [a, b, c] : refined.mesh.facets)
      ASSERT_TRUE(mesh.add_face(handle[a], handle[b], handle[c]).is_valid());
    for (const auto edge : mesh.edges()) EXPECT_FALSE(mesh.is_boundary(edge));
    const auto n = [](std::size_t k) { return static_cast<long>(k); };
    EXPECT_EQ(n(mesh.n_vertices()) - n(mesh.n_edges()) + n(mesh.n_faces()), 2);
    EXPECT_GT(mesh.n_faces(), 200u);
  }
}

TEST(EdgeRefinement, NoEdgeThatIsToBeCutIsLeft) {
  const FacetMesh base = knotted_random_triangles(5);
  const SizeRule rule = rough_rule(5, 0.4);
  const RefinedMesh refined = refine(base, all_of(base), grid, rule, stay);
  for (std::size_t s = 0; s < refined.mesh.facets.size(); ++s)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& f = refined.mesh.facets[s];
      BasePoint a, b;
      a.at_m = grid.to_metres(refined.mesh.vertices[f[k]]);
      b.at_m = grid.to_metres(refined.mesh.vertices[f[(k + 1) % 3]]);
      EXPECT_FALSE(rule.cuts(a, b));
    }
}

using Corners = std::set<std::array<GridPoint, 3>>;
Corners corners_near(const RefinedMesh& refined, glm::dvec3 centre, double radius) {
  Corners near;
  for (const auto& f : refined.mesh.facets) {
    // Searches a point of the facet in the sphere by a fine scan over barycentric coordinates.
    const glm::dvec3 a = grid.to_metres(refined.mesh.vertices[f[0]]),
                     b = grid.to_metres(refined.mesh.vertices[f[1]]),
                     c = grid.to_metres(refined.mesh.vertices[f[2]]);
    bool meets = false;
    for (int i = 0; i <= 8; ++i)
      for (int j = 0; i + j <= 8; ++j)
        meets = meets || glm::distance(a + (b - a) * (i / 8.0) + (c - a) * (j / 8.0), centre) < radius;
    if (meets)
      near.insert({refined.mesh.vertices[f[0]], refined.mesh.vertices[f[1]], refined.mesh.vertices[f[2]]});
  }
  return near;
}

/// The guarantee of local refinement. A rule cuts an edge if the sphere of twice its length about its
/// midpoint meets a region. It gives the same facets in the region as a rule that cuts everywhere.
// Law D3.
TEST(EdgeRefinement, LocalRefinementEqualsUniformRefinementWhereItLooks) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE(seed);
    const FacetMesh base = knotted_random_triangles(seed);
    Random random(seed);
    const GridPoint at = base.vertices[static_cast<std::size_t>(uniform(random, 0, 8))];
    const glm::dvec3 centre =
        0.7 * grid.to_metres(at) + 0.3 * grid.to_metres(base.vertices[base.facets[seed % 25][1]]);
    const double radius = 1.2, h = 0.5;
    const SizeRule local([&](glm::dvec3 middle, double length) {
      return glm::distance(middle, centre) < radius + 2 * length ? h : 1e9;
    });
    const RefinedMesh everywhere = refine(base, all_of(base), grid, uniform_rule(h), stay),
                      there = refine(base, all_of(base), grid, local, stay);
    EXPECT_LT(there.mesh.facets.size(), everywhere.mesh.facets.size());
    EXPECT_EQ(corners_near(there, centre, radius), corners_near(everywhere, centre, radius));
  }
}

// Law D4.
TEST(EdgeRefinement, DoesNotDependOnThreadsOrOnOtherFacets) {
  const FacetMesh base = knotted_random_triangles(11);
  const SizeRule rule = rough_rule(11, 0.2);
  const auto with_threads = [&](std::size_t threads, const std::vector<FacetId>& facets) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    return refine(base, facets, grid, rule, stay);
  };
  const RefinedMesh one = with_threads(1, all_of(base)), four = with_threads(4, all_of(base));
  EXPECT_EQ(one.mesh.vertices, four.mesh.vertices);
  EXPECT_EQ(one.mesh.facets, four.mesh.facets);
  EXPECT_EQ(one.parent, four.parent);
  std::size_t at = 0;
  for (const FacetId f : all_of(base)) {
    const RefinedMesh alone = refine(base, std::vector{f}, grid, rule, stay);
    for (const auto& part : alone.mesh.facets) {
      ASSERT_EQ(one.parent[at], f);
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_EQ(one.mesh.vertices[one.mesh.facets[at][k]], alone.mesh.vertices[part[k]]);
      ++at;
    }
  }
  EXPECT_EQ(at, one.mesh.facets.size());
}

TEST(EdgeRefinement, CountsWhatUniformRefinementWouldMake) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const FacetMesh base = knotted_random_triangles(seed);
    for (FacetId f = 0; f < base.facets.size(); ++f)
      for (const double h : {0.3, 1.1, 100.0})
        EXPECT_EQ(uniform_count(base, f, grid, h),
                  refine(base, std::vector{f}, grid, uniform_rule(h), stay).mesh.facets.size())
            << "seed " << seed << ", facet " << f << ", h " << h;
  }
  // A square of 100 m in cells of 1 cm, counted without making it: bisected 14 times, 0.61 cm.
  FacetMesh square;
  const std::int32_t side = 100 << 10;
  for (const GridPoint p : {GridPoint{0, 0, 0}, {side, 0, 0}, {side, side, 0}}) add_vertex(square, p);
  add_facet(square, 0, 1, 2);
  EXPECT_EQ(uniform_count(square, 0, grid, 0.01), std::size_t{1} << 28);
}

TEST(EdgeRefinement, RefusesWhatIsTooLargeOrTooDeep) {
  const FacetMesh base = octahedron(1 << 12);
  EXPECT_THROW(refine(base, all_of(base), grid, uniform_rule(0.01), stay, {1000}), RefinementTooLarge);
  EXPECT_NO_THROW(refine(base, all_of(base), grid, uniform_rule(100), stay, {8}));
  EXPECT_THROW(refine(base, all_of(base), grid, uniform_rule(100), stay, {7}), RefinementTooLarge);
  // A rule that never stops cutting the edges at one vertex.
  const glm::dvec3 top = grid.to_metres(base.vertices[4]);
  const SizeRule endless([&](glm::dvec3 middle, double length) {
    return glm::distance(middle, top) < 0.6 * length ? 0.0 : 1e9;
  });
  EXPECT_THROW(refine(base, all_of(base), grid, endless, stay), std::range_error);
  EXPECT_THROW(
      refine(base, all_of(base), grid, uniform_rule(100), [](const BasePoint&) { return glm::dvec3{1e9}; }),
      GridRangeError);
  EXPECT_TRUE(refine(base, {}, grid, uniform_rule(1), stay).mesh.facets.empty());
}

}  // namespace
}  // namespace tubefoot
