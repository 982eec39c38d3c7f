// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "geometry/facet_mesh.hpp"
#include "geometry/tube.hpp"

// Small seeded scenes straight on the grid, for tests of the kernel. Coordinates are grid units.
namespace tubefoot::test {

using Random = std::mt19937_64;

inline std::int32_t uniform(Random& random, std::int32_t lo, std::int32_t hi) {
  return std::uniform_int_distribution<std::int32_t>(lo, hi)(random);
}

inline void add_facet(FacetMesh& mesh, VertexId a, VertexId b, VertexId c) {
  mesh.facets.push_back({a, b, c});
  mesh.material.push_back(0);
  mesh.component.push_back(0);
}

inline VertexId add_vertex(FacetMesh& mesh, GridPoint p) {
  mesh.vertices.push_back(p);
  return static_cast<VertexId>(mesh.vertices.size() - 1);
}

/// Gives vertices at the same grid point the same id, as loading does.
inline void weld(FacetMesh& mesh) {
  for (auto& facet : mesh.facets)
    for (VertexId& v : facet)
      for (VertexId w = 0; w < v; ++w)
        if (mesh.vertices[w] == mesh.vertices[v]) v = w;
}

/// `count` random facets about (0, distance, 0) that cut through each other.
inline FacetMesh random_soup(Random& random, int count, std::int32_t distance, std::int32_t spread) {
  FacetMesh mesh;
  for (int k = 0; k < count; ++k) {
    VertexId v[3];
    for (VertexId& id : v)
      id = add_vertex(mesh, {uniform(random, -spread, spread), distance + uniform(random, -spread, spread),
                             uniform(random, -spread, spread)});
    add_facet(mesh, v[0], v[1], v[2]);
  }
  weld(mesh);
  return mesh;
}

/// A height field of 2 n^2 facets over [-width/2, width/2] x [0, width], rough by `relief`.
inline FacetMesh rough_terrain(Random& random, int n, std::int32_t width, std::int32_t height, std::int32_t relief) {
  FacetMesh mesh;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i)
      add_vertex(mesh, {static_cast<std::int32_t>(std::int64_t(width) * i / n - width / 2),
                        static_cast<std::int32_t>(std::int64_t(width) * j / n),
                        height + uniform(random, -relief, relief)});
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const auto a = static_cast<VertexId>(j * (n + 1) + i), b = a + 1, c = a + n + 1, d = c + 1;
      add_facet(mesh, a, b, d);
      add_facet(mesh, a, d, c);
    }
  return mesh;
}

/// Tubes about the direction (0, 1, 0): `columns` x `rows` cells of `width_deg` x `height_deg` in all, tilted down.
inline TubeSet forward_tubes(GridPoint apex, int columns, int rows, double width_deg, double height_deg,
                             double tilt_deg = 0) {
  const double degree = std::acos(-1.0) / 180;
  AngularGrid grid;
  for (int k = 0; k <= columns; ++k) grid.azimuth_edges_rad.push_back((k - columns / 2.0) * width_deg / columns * degree);
  for (int k = 0; k <= rows; ++k) grid.elevation_edges_rad.push_back((k - rows / 2.0) * height_deg / rows * degree);
  const double c = std::cos(tilt_deg * degree), s = std::sin(tilt_deg * degree);
  grid.frame = glm::dmat3(glm::dvec3(0, c, -s), glm::dvec3(1, 0, 0), glm::dvec3(0, s, c));
  TubeSet set;
  set.apex = apex;
  set.reach = 1e12;
  append_tubes(set, grid);
  return set;
}

}  // namespace tubefoot::test
