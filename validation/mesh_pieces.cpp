// SPDX-License-Identifier: GPL-3.0-or-later
// Elements of the cases: random numbers, facets, sheets, spheres, seabeds and parallelogram tubes, directly
// on the integer grid.
#include "validation/mesh_pieces.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_map>
#include <utility>

namespace tubefoot::atlas {

std::int32_t uniform(Random& random, std::int32_t lo, std::int32_t hi) {
  const auto count = static_cast<std::uint64_t>(std::int64_t(hi) - lo + 1);
  return static_cast<std::int32_t>(lo + static_cast<std::int64_t>(random() % count));
}

VertexId add_vertex(FacetMesh& mesh, GridPoint p) {
  mesh.vertices.push_back(p);
  return static_cast<VertexId>(mesh.vertices.size() - 1);
}

void add_facet(FacetMesh& mesh, VertexId a, VertexId b, VertexId c) {
  mesh.facets.push_back({a, b, c});
  mesh.material.push_back(0);
  mesh.component.push_back(0);
}

void add_facet(FacetMesh& mesh, GridPoint a, GridPoint b, GridPoint c) {
  const VertexId i = add_vertex(mesh, a), j = add_vertex(mesh, b), k = add_vertex(mesh, c);
  add_facet(mesh, i, j, k);
}

void add_sphere(FacetMesh& mesh, GridPoint centre, std::int32_t radius, int times) {
  FacetMesh sphere;
  VertexId tip[3][2];
  for (int axis = 0; axis < 3; ++axis)
    for (int end = 0; end < 2; ++end) {
      const std::int32_t r = end ? radius : -radius;
      tip[axis][end] = add_vertex(sphere, {axis == 0 ? r : 0, axis == 1 ? r : 0, axis == 2 ? r : 0});
    }
  for (int k = 0; k < 8; ++k) add_facet(sphere, tip[0][k & 1], tip[1][k >> 1 & 1], tip[2][k >> 2 & 1]);
  for (; times > 0; --times) {
    std::map<std::pair<VertexId, VertexId>, VertexId> middles;
    const auto middle = [&](VertexId a, VertexId b) {
      const auto [place, is_new] = middles.try_emplace(std::minmax(a, b), 0);
      if (is_new) {
        const GridPoint p = sphere.vertices[a], q = sphere.vertices[b];
        const double x = double(p.x) + q.x, y = double(p.y) + q.y, z = double(p.z) + q.z;
        const double scale = radius / std::sqrt(x * x + y * y + z * z);
        const auto rounded = [&](double c) { return static_cast<std::int32_t>(std::lround(c * scale)); };
        place->second = add_vertex(sphere, {rounded(x), rounded(y), rounded(z)});
      }
      return place->second;
    };
    const auto coarse = std::exchange(sphere.facets, {});
    for (const auto& [a, b, c] : coarse) {
      const VertexId ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      add_facet(sphere, a, ab, ca);
      add_facet(sphere, ab, b, bc);
      add_facet(sphere, ca, bc, c);
      add_facet(sphere, ab, bc, ca);
    }
  }
  const auto first = static_cast<VertexId>(mesh.vertices.size());
  for (const GridPoint& p : sphere.vertices)
    add_vertex(mesh, {p.x + centre.x, p.y + centre.y, p.z + centre.z});
  for (const auto& [a, b, c] : sphere.facets) add_facet(mesh, a + first, b + first, c + first);
}

void add_seabed(Random& random, FacetMesh& mesh, int n, std::int32_t width, std::int32_t z,
                std::int32_t swell, std::int32_t roughness) {
  add_sheet(mesh, n, n, [&](int u, int v) {
    const double s = double(u) / n, t = double(v) / n;
    const double smooth = swell * (std::sin(7 * s + 3 * t) * std::cos(9 * t - 2 * s));
    return GridPoint{
        static_cast<std::int32_t>(std::int64_t(width) * u / n - width / 2),
        static_cast<std::int32_t>(std::int64_t(width) * v / n),
        z + static_cast<std::int32_t>(std::lround(smooth)) + uniform(random, -roughness, roughness)};
  });
}

void weld(FacetMesh& mesh) {
  std::unordered_map<GridPoint, VertexId, GridPointHash> first;
  std::vector<VertexId> renamed(mesh.vertices.size());
  std::vector<GridPoint> kept;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const auto [place, is_new] = first.try_emplace(mesh.vertices[v], static_cast<VertexId>(kept.size()));
    if (is_new) kept.push_back(mesh.vertices[v]);
    renamed[v] = place->second;
  }
  mesh.vertices = std::move(kept);
  for (auto& facet : mesh.facets)
    for (VertexId& v : facet) v = renamed[v];
}

TubeSet parallelogram_tubes(GridPoint apex, GridPoint first, GridPoint across, GridPoint up, int columns,
                            int rows) {
  TubeSet set;
  set.apex = apex;
  set.reach = 1e12;
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i <= columns; ++i)
      set.rays.push_back({first.x + i * across.x + j * up.x, first.y + i * across.y + j * up.y,
                          first.z + i * across.z + j * up.z});
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      const auto a = static_cast<std::uint32_t>(j * (columns + 1) + i),
                 b = a + static_cast<std::uint32_t>(columns) + 1;
      set.tubes.push_back({a, b, b + 1, a + 1});
    }
  return set;
}

}  // namespace tubefoot::atlas
