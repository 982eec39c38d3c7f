// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh/plan_cut.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <set>
#include <stdexcept>

#include "fixtures/processor_time.hpp"
#include "geometry/mesh/facet_mesh.hpp"
#include "geometry/mesh/voronoi.hpp"

// Tests facets that are cut along lines of a chart. The parts are a partition of each facet, with the same
// vertices on both sides of each edge, for any lines and meshes.
namespace tubefoot {
namespace {

using PointTriangle = std::array<std::uint32_t, 3>;

struct Mesh {
  std::vector<glm::dvec3> points;
  std::vector<PointTriangle> triangles;
};

double cross_in_plan(glm::dvec2 u, glm::dvec2 v) { return u.x * v.y - u.y * v.x; }

double area_from_above(const Mesh& mesh, const PointTriangle& t) {
  const glm::dvec2 a = mesh.points[t[0]], b = mesh.points[t[1]], c = mesh.points[t[2]];
  return cross_in_plan(b - a, c - a) / 2;
}

/// Hills on a grid of n x n cells whose inner vertices are displaced.
Mesh hills(std::mt19937_64& random, int n, double size) {
  std::uniform_real_distribution<double> aside(-0.3, 0.3), up(-0.4, 0.4);
  Mesh mesh;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const bool inner = i > 0 && j > 0 && i < n && j < n;
      const double east = i + inner * aside(random), north = j + inner * aside(random), height = up(random);
      mesh.points.emplace_back(east * size / n, north * size / n, height * size / n);
    }
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const auto a = static_cast<std::uint32_t>(j * (n + 1) + i), b = a + 1,
                 c = a + static_cast<std::uint32_t>(n) + 1, d = c + 1;
      mesh.triangles.push_back({a, b, d});
      mesh.triangles.push_back({a, d, c});
    }
  return mesh;
}

Mesh unit_square() { return {{{0, 0, 0}, {1, 0, 0}, {1, 1, 1}, {0, 1, 2}}, {{0, 1, 2}, {0, 2, 3}}}; }

/// Returns edges with a facet on one side only, as index pairs. No edge may have more than two facets.
std::vector<std::pair<std::uint32_t, std::uint32_t>> open_edges(const std::vector<PointTriangle>& triangles) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> sides;
  for (const PointTriangle& t : triangles)
    for (unsigned k = 0; k < 3; ++k) ++sides[std::minmax(t[k], t[(k + 1) % 3])];
  std::vector<std::pair<std::uint32_t, std::uint32_t>> open;
  for (const auto& [edge, count] : sides) {
    EXPECT_LE(count, 2);
    if (count == 1) open.push_back(edge);
  }
  return open;
}

/// Checks the laws of a cut for a mesh that covers the square 0 .. size. Returns the mesh of parts.
Mesh expect_lawful(const Mesh& mesh, const std::vector<PlanSegment>& segments, double size) {
  Mesh parts = mesh;
  const PlanCut cut = cut_in_plan(parts.points, mesh.triangles, segments);
  parts.triangles = cut.triangles;
  EXPECT_EQ(cut.facet.size(), cut.triangles.size());
  EXPECT_TRUE(std::ranges::is_sorted(cut.facet));
  EXPECT_TRUE(std::equal(mesh.points.begin(), mesh.points.end(), parts.points.begin()));

  // No facet is lost, each is partitioned, and the parts have its plane and orientation.
  std::vector<double> area(mesh.triangles.size());
  std::vector<std::size_t> count(mesh.triangles.size());
  for (std::size_t k = 0; k < parts.triangles.size(); ++k) {
    const std::uint32_t f = cut.facet[k];
    ++count[f];
    const double part = area_from_above(parts, parts.triangles[k]),
                 whole = area_from_above(mesh, mesh.triangles[f]);
    area[f] += part;
    EXPECT_GT(part * std::copysign(1.0, whole), -1e-13 * size * size);
    const glm::dvec3 a = mesh.points[mesh.triangles[f][0]], u = mesh.points[mesh.triangles[f][1]] - a,
                     v = mesh.points[mesh.triangles[f][2]] - a;
    for (const std::uint32_t index : parts.triangles[k]) {
      const glm::dvec3 p = parts.points[index] - a;
      const double s = cross_in_plan(p, v) / (2 * whole), t = cross_in_plan(u, p) / (2 * whole);
      EXPECT_NEAR(p.z, s * u.z + t * v.z, 1e-12 * size);
    }
  }
  std::size_t cut_facets = 0;
  for (std::size_t f = 0; f < area.size(); ++f) {
    EXPECT_GE(count[f], 1u);
    EXPECT_NEAR(area[f], area_from_above(mesh, mesh.triangles[f]), 1e-12 * size * size);
    cut_facets += count[f] > 1;
    if (count[f] == 1) {
      const auto k = std::ranges::find(cut.facet, f) - cut.facet.begin();
      EXPECT_EQ(cut.triangles[static_cast<std::size_t>(k)], mesh.triangles[f]);
    }
  }
  EXPECT_EQ(cut.cut_facets, cut_facets);

  // Conforming: only edges of the outline are open, and the outline keeps its length.
  double outline = 0;
  for (const auto& [i, j] : open_edges(parts.triangles)) {
    const glm::dvec2 p = parts.points[i], q = parts.points[j];
    const bool on_outline =
        (p.x == q.x && (p.x == 0 || p.x == size)) || (p.y == q.y && (p.y == 0 || p.y == size));
    EXPECT_TRUE(on_outline) << p.x << ' ' << p.y << " to " << q.x << ' ' << q.y;
    outline += std::hypot(p.x - q.x, p.y - q.y);
  }
  EXPECT_NEAR(outline, 4 * size, 1e-12 * size);
  return parts;
}

/// Expects that no segment enters a part: the part is on one side of its line, or beyond its ends.
void expect_no_part_entered(const Mesh& parts, const std::vector<PlanSegment>& segments, double size) {
  for (const PointTriangle& t : parts.triangles) {
    if (std::abs(area_from_above(parts, t)) < 1e-10 * size * size) continue;
    glm::dvec2 middle(0);
    for (const std::uint32_t index : t) middle += glm::dvec2(parts.points[index]) / 3.0;
    for (const PlanSegment& s : segments)
      for (unsigned k = 0; k < 3; ++k) {
        // No segment may cross the line from the middle to a point just inside a corner.
        const glm::dvec2 p = middle, q = middle + 0.999999 * (glm::dvec2(parts.points[t[k]]) - middle);
        const double side_p = cross_in_plan(s.b - s.a, p - s.a), side_q = cross_in_plan(s.b - s.a, q - s.a);
        const double side_a = cross_in_plan(q - p, s.a - p), side_b = cross_in_plan(q - p, s.b - p);
        EXPECT_FALSE(side_p * side_q < 0 && side_a * side_b < 0);
      }
  }
}

/// Returns whether each half-edge occurs once, and a border passes each vertex once.
bool is_sheet(const FacetMesh& mesh) {
  std::set<std::pair<VertexId, VertexId>> half_edges;
  for (const auto& facet : mesh.facets)
    for (std::size_t k = 0; k < 3; ++k)
      if (!half_edges.insert({facet[k], facet[(k + 1) % 3]}).second) return false;
  std::set<VertexId> border_starts;
  for (const auto& [from, to] : half_edges)
    if (!half_edges.contains({to, from}) && !border_starts.insert(from).second) return false;
  return true;
}

// Laws U1 and U2.
TEST(PlanCut, RandomLinesOverRandomHills) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const double size = 7;
    const Mesh mesh = hills(random, 6, size);
    std::uniform_real_distribution<double> anywhere(-2, size + 2);
    std::vector<PlanSegment> segments(seed % 2 == 0 ? 3 : 15);
    for (PlanSegment& s : segments)
      s = {{anywhere(random), anywhere(random)}, {anywhere(random), anywhere(random)}};
    const Mesh parts = expect_lawful(mesh, segments, size);
    expect_no_part_entered(parts, segments, size);

    // On the grid of the scene it is still a surface.
    MeshBuilder builder(WorldGrid(20, {size / 2, size / 2, 0}));
    builder.add(parts.points, parts.triangles, 0, 0);
    MeshReport report;
    const FacetMesh on_grid = builder.finish(report);
    EXPECT_TRUE(is_sheet(on_grid));
    EXPECT_LT(report.largest_snap_m, 0.5 * std::sqrt(3.0) / (1 << 20) * (1 + 1e-9));
  }
}

bool stands_vertical(const Mesh& mesh) {
  return std::any_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const PointTriangle& t) {
    const glm::dvec3 a = mesh.points[t[0]], b = mesh.points[t[1]] - a, c = mesh.points[t[2]] - a;
    return b.x * c.y == b.y * c.x;  // integers
  });
}

// Coordinates of few bits: lines often contain vertices and edges, coincide, and end on edges. Laws U1 and
// U2.
TEST(PlanCut, LinesThroughVerticesAndAlongEdges) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    Mesh mesh;
    do {
      mesh = hills(random, 4, 16);
      for (glm::dvec3& p : mesh.points) p = {std::round(p.x), std::round(p.y), std::round(p.z)};
    } while (stands_vertical(mesh));
    std::uniform_int_distribution<int> anywhere(-1, 17);
    std::vector<PlanSegment> segments(8);
    for (PlanSegment& s : segments) {
      do {
        s = {{anywhere(random), anywhere(random)}, {anywhere(random), anywhere(random)}};
      } while (s.a == s.b);
    }
    segments.push_back({segments[0].b, segments[0].a});
    const Mesh parts = expect_lawful(mesh, segments, 16);
    expect_no_part_entered(parts, segments, 16);
  }
}

std::size_t parts_of_square(std::vector<PlanSegment> segments, std::size_t* points = nullptr) {
  const Mesh parts = expect_lawful(unit_square(), segments, 1);
  if (points != nullptr) *points = parts.points.size();
  return parts.triangles.size();
}

TEST(PlanCut, WhatOnlyTouchesLeavesFacetsWhole) {
  EXPECT_EQ(parts_of_square({}), 2u);
  EXPECT_EQ(parts_of_square({{{0, 0}, {1, 1}}}), 2u) << "along the edge between them";
  EXPECT_EQ(parts_of_square({{{-3, -3}, {5, 5}}}), 2u) << "along it and beyond";
  EXPECT_EQ(parts_of_square({{{0, 0}, {1, 0}}, {{1, 0}, {1, 1}}}), 2u) << "along the outline";
  EXPECT_EQ(parts_of_square({{{-1, 1}, {1, -1}}}), 2u) << "tangent at a corner";
  EXPECT_EQ(parts_of_square({{{-1, 0.5}, {-1e-300, 0.5}}}), 2u) << "ends just outside";
  EXPECT_EQ(parts_of_square({{{2, 2}, {3, 2}}}), 2u) << "elsewhere";
}

TEST(PlanCut, SharedEdgeIsSplitOnBothSides) {
  std::size_t points = 0;
  EXPECT_EQ(parts_of_square({{{0.25, 0.25}, {0.75, 0.75}}}, &points), 6u) << "along a part of the diagonal";
  EXPECT_EQ(points, 6u);
  EXPECT_EQ(parts_of_square({{{0.5, 0.5}, {1, 0}}}, &points), 4u) << "ends on the diagonal from one side";
  EXPECT_EQ(points, 5u);
  EXPECT_EQ(parts_of_square({{{0, 1}, {1, 0}}}, &points), 4u) << "from corner to corner across";
  EXPECT_EQ(points, 5u);
  EXPECT_EQ(parts_of_square({{{0, 1}, {1, 0}}, {{1, 0}, {0, 1}}, {{-1, 2}, {2, -1}}}, &points), 4u)
      << "three times the same";
  EXPECT_EQ(points, 5u);
}

TEST(PlanCut, EndsOnTheOutlineMakeAVertex) {
  std::size_t points = 0;
  EXPECT_EQ(parts_of_square({{{0, 0.5}, {-1, 0.5}}}, &points), 3u) << "from outside, onto the outline";
  EXPECT_EQ(points, 5u);
  EXPECT_EQ(parts_of_square({{{0.5, 0.25}, {0.5, 0.25}}}, &points), 4u) << "of no length, inside";
  EXPECT_EQ(points, 5u);
}

// The border misses a vertex by less than the grid unit. It makes slivers, but no facet is lost and no gap
// opens.
TEST(PlanCut, SliversStayASheet) {
  const double unit = 1.0 / (1 << 20);
  Mesh mesh = unit_square();
  mesh.points.clear();
  for (const glm::dvec3 p : {glm::dvec3(0, 0, 0), {1, 0, 0}, {1, 1, 1}, {0, 1, 2}}) mesh.points.push_back(p);
  for (const double by : {1e-16, 1e-9, 0.3 * unit, 0.6 * unit, 3 * unit}) {
    SCOPED_TRACE(by);
    const Mesh parts = expect_lawful(mesh, {{{-1, by}, {2, by}}, {{by, -1}, {1 - by, 2}}}, 1);
    MeshBuilder builder(WorldGrid(20, {0, 0, 0}));
    builder.add(parts.points, parts.triangles, 0, 0);
    MeshReport report;
    const FacetMesh on_grid = builder.finish(report);
    EXPECT_EQ(on_grid.facets.size(), parts.triangles.size());
    // Facets that have become a line fill no gap and make none: only edges of the outline stay open.
    // signed: inner edges of a surface occur in both directions
    std::map<std::pair<VertexId, VertexId>, int> along;
    for (const auto& f : on_grid.facets)
      for (unsigned k = 0; k < 3; ++k) {
        const VertexId p = f[k], q = f[(k + 1) % 3];
        if (p != q) along[std::minmax(p, q)] += p < q ? 1 : -1;
      }
    for (const auto& [edge, count] : along) {
      if (count == 0) continue;
      const GridPoint p = on_grid.vertices[edge.first], q = on_grid.vertices[edge.second];
      EXPECT_TRUE((p.x == q.x && (p.x == 0 || p.x == 1 << 20)) ||
                  (p.y == q.y && (p.y == 0 || p.y == 1 << 20)));
    }
  }
}

TEST(PlanCut, FacetsTurnedOverStayTurnedOver) {
  Mesh mesh = unit_square();
  for (PointTriangle& t : mesh.triangles) std::swap(t[1], t[2]);
  expect_lawful(mesh, {{{0.1, -1}, {0.7, 2}}, {{-1, 0.4}, {2, 0.3}}}, 1);
}

TEST(PlanCut, VerticalFacetsAreRefusedOnlyWhereABorderMeetsThem) {
  Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {1, 0, 1}}, {{0, 1, 2}}};
  EXPECT_EQ(cut_in_plan(mesh.points, mesh.triangles, std::vector<PlanSegment>{{{2, -1}, {2, 1}}}).cut_facets,
            0u);
  EXPECT_THROW(cut_in_plan(mesh.points, mesh.triangles, std::vector<PlanSegment>{{{0.5, -1}, {0.5, 1}}}),
               std::domain_error);
}

TEST(PlanCut, ManyLinesInOneFacet) {
  std::vector<PlanSegment> fan;
  const Mesh square = unit_square();
  for (int k = 1; k < 200; ++k) fan.push_back({{k / 200.0, -1}, {k / 200.0, 2}});
  const Mesh parts = expect_lawful(square, fan, 1);
  expect_no_part_entered(parts, fan, 1);
  // 199 lines and the diagonal: the corners of all strips, cut by the diagonal.
  EXPECT_EQ(parts.points.size(), 4u + 3 * 199);
}

/// Regular polygons about random points of the unit square.
std::vector<PlanSegment> overlapping(std::size_t polygons, int corners, double largest) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> anywhere(0, 1), size(0.2 * largest, largest);
  std::vector<PlanSegment> segments;
  for (std::size_t k = 0; k < polygons; ++k) {
    const glm::dvec2 middle(anywhere(random), anywhere(random));
    const double radius = size(random), turned = anywhere(random);
    const auto corner = [&](int i) {
      const double angle = 2 * std::numbers::pi * (i % corners + turned) / corners;
      return middle + radius * glm::dvec2(std::cos(angle), std::sin(angle));
    };
    for (int i = 0; i < corners; ++i) segments.push_back({corner(i), corner(i + 1)});
  }
  return segments;
}

TEST(PlanCut, PolygonsThatOverlapEndInTime) {
  const std::vector<PlanSegment> some = overlapping(60, 7, 0.3);
  expect_no_part_entered(expect_lawful(unit_square(), some, 1), some, 1);
  Mesh square = unit_square();
  const std::vector<PlanSegment> many = overlapping(400, 4, 0.2);
  EXPECT_LT(processor_seconds([&] { cut_in_plan(square.points, square.triangles, many); }), hostile_input_s);
  EXPECT_GT(square.points.size(), 10'000u);
}

// Thousands of intersecting lines give millions of parts.
TEST(PlanCut, SegmentsThatCrossTooOftenAreRefused) {
  Mesh square = unit_square();
  const std::vector<PlanSegment> many = overlapping(800, 40, 1);
  const double seconds = processor_seconds(
      [&] { EXPECT_THROW(cut_in_plan(square.points, square.triangles, many), std::length_error); });
  EXPECT_LT(seconds, hostile_input_s);
}

TEST(PlanCut, ACombOfLongTeethEndsInTime) {
  std::vector<PlanSegment> comb;
  constexpr int teeth = 2500;
  for (int k = 0; k < teeth; ++k) {
    const double left = (k + 0.25) / teeth, right = (k + 0.75) / teeth, next = (k + 1.25) / teeth;
    comb.push_back({{left, 0.1}, {left, 0.9}});
    comb.push_back({{left, 0.9}, {right, 0.9}});
    comb.push_back({{right, 0.9}, {right, 0.1}});
    if (k + 1 < teeth) comb.push_back({{right, 0.1}, {next, 0.1}});
  }
  Mesh square = unit_square();
  EXPECT_LT(processor_seconds([&] { cut_in_plan(square.points, square.triangles, comb); }), hostile_input_s);
  // Four corners per tooth, and the intersections of the diagonal with most of them.
  EXPECT_GT(square.points.size(), 5u * teeth);
}

// Law U3.
TEST(VoronoiEdges, LieMidwayAndHaveNoNearerSite) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> anywhere(0, 10);
  std::vector<glm::dvec2> sites(60);
  for (glm::dvec2& site : sites) site = {anywhere(random), anywhere(random)};
  const auto edges = voronoi_edges(sites);
  EXPECT_GT(edges.size(), 100u);
  std::map<std::pair<double, double>, int> meeting;
  for (const VoronoiEdge& edge : edges) {
    for (const double t : {0.01, 0.5, 0.99}) {
      const glm::dvec2 p = edge.a + t * (edge.b - edge.a);
      const auto away = [&](glm::dvec2 site) { return std::hypot(p.x - site.x, p.y - site.y); };
      const double own = away(sites[edge.site]), reach = 1e-9 * (1 + own);
      EXPECT_NEAR(own, away(sites[edge.other_site]), reach);
      for (const glm::dvec2& site : sites) EXPECT_GE(away(site), own - reach);
    }
    ++meeting[{edge.a.x, edge.a.y}];
    ++meeting[{edge.b.x, edge.b.y}];
  }
  // Three cells meet at a vertex: three edges, except for infinite ones.
  for (const auto& [vertex, count] : meeting) EXPECT_LE(count, 3);
  EXPECT_GT(std::ranges::count_if(meeting, [](const auto& m) { return m.second == 3; }), 60);
}

}  // namespace
}  // namespace tubefoot
