// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "geometry/mesh/facet_mesh.hpp"
#include "geometry/tubes/tube.hpp"

// Small seeded scenes straight on the grid, for tests of the kernel. Coordinates are grid units.
namespace tubefoot::test {

using Random = std::mt19937_64;

/// Sanitizers make rationals some fifty times slower: with them, one in so many of the seeds (and of the
/// cases that a test expects at least) has to do.
#ifdef TUBEFOOT_SANITIZED
constexpr std::uint64_t one_in = 8;
#else
constexpr std::uint64_t one_in = 1;
#endif

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
inline FacetMesh rough_terrain(Random& random, int n, std::int32_t width, std::int32_t height,
                               std::int32_t relief) {
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

/// Tubes about the direction (0, 1, 0): `columns` x `rows` cells of `width_deg` x `height_deg` in all, tilted
/// down.
inline TubeSet forward_tubes(GridPoint apex, int columns, int rows, double width_deg, double height_deg,
                             double tilt_deg = 0) {
  const double degree = std::acos(-1.0) / 180;
  AngularGrid grid;
  for (int k = 0; k <= columns; ++k)
    grid.azimuth_edges_rad.push_back((k - columns / 2.0) * width_deg / columns * degree);
  for (int k = 0; k <= rows; ++k)
    grid.elevation_edges_rad.push_back((k - rows / 2.0) * height_deg / rows * degree);
  const double c = std::cos(tilt_deg * degree), s = std::sin(tilt_deg * degree);
  grid.frame = glm::dmat3(glm::dvec3(0, c, -s), glm::dvec3(1, 0, 0), glm::dvec3(0, s, c));
  TubeSet set;
  set.apex = apex;
  set.reach = 1e12;
  append_tubes(set, grid);
  return set;
}

/// Tubes whose rays go through the lattice points (x0 + i, distance, z0 + j) * unit: walls and rays can be
/// made to meet edges and vertices of a mesh exactly.
inline TubeSet lattice_tubes(GridPoint apex, std::int32_t x0, std::int32_t z0, int columns, int rows,
                             std::int32_t distance, std::int32_t unit = 1) {
  TubeSet set;
  set.apex = apex;
  set.reach = 1e12;
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i <= columns; ++i)
      set.rays.push_back({(x0 + i) * unit, distance * unit, (z0 + j) * unit});
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      const auto a = static_cast<std::uint32_t>(j * (columns + 1) + i),
                 b = a + static_cast<std::uint32_t>(columns) + 1;
      set.tubes.push_back({a, b, b + 1, a + 1});
    }
  return set;
}

/// A closed box and a closed octahedron, edges shared.
inline void add_box(FacetMesh& mesh, GridPoint centre, std::int32_t half) {
  const auto first = static_cast<VertexId>(mesh.vertices.size());
  for (int k = 0; k < 8; ++k)
    add_vertex(mesh, {centre.x + (k & 1 ? half : -half), centre.y + (k & 2 ? half : -half),
                      centre.z + (k & 4 ? half : -half)});
  for (const auto& q : {std::array<VertexId, 4>{0, 1, 3, 2},
                        {4, 5, 7, 6},
                        {0, 1, 5, 4},
                        {2, 3, 7, 6},
                        {0, 2, 6, 4},
                        {1, 3, 7, 5}}) {
    add_facet(mesh, first + q[0], first + q[1], first + q[2]);
    add_facet(mesh, first + q[0], first + q[2], first + q[3]);
  }
}

inline void add_octahedron(FacetMesh& mesh, GridPoint centre, std::int32_t radius) {
  VertexId tip[3][2];
  for (int axis = 0; axis < 3; ++axis)
    for (int end = 0; end < 2; ++end) {
      const std::int32_t r = end ? radius : -radius;
      tip[axis][end] = add_vertex(mesh, {centre.x + (axis == 0 ? r : 0), centre.y + (axis == 1 ? r : 0),
                                         centre.z + (axis == 2 ? r : 0)});
    }
  for (int k = 0; k < 8; ++k) add_facet(mesh, tip[0][k & 1], tip[1][k >> 1 & 1], tip[2][k >> 2 & 1]);
}

/// Each facet once more, its vertices turned or swapped; `own_vertices` gives the copy vertices of its own.
inline void duplicate_facets(Random& random, FacetMesh& mesh, bool own_vertices) {
  const std::size_t count = mesh.facets.size();
  for (std::size_t f = 0; f < count; ++f) {
    auto v = mesh.facets[f];
    std::shuffle(v.begin(), v.end(), random);
    if (own_vertices)
      for (VertexId& id : v) id = add_vertex(mesh, mesh.vertices[id]);
    add_facet(mesh, v[0], v[1], v[2]);
  }
}

/// A vertical plate of n x n quads of size `step`, facing the apex at `distance`; neighbouring columns are
/// cut at different heights (T-junctions) if `uneven`.
inline void add_plate(FacetMesh& mesh, std::int32_t distance, int n, std::int32_t step, bool uneven) {
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const std::int32_t shift = uneven && i % 2 ? step / 2 : 0, x = (2 * i - n) * step / 2,
                         z = (2 * j - n) * step / 2 + shift;
      const VertexId a = add_vertex(mesh, {x, distance, z}), b = add_vertex(mesh, {x + step, distance, z}),
                     c = add_vertex(mesh, {x, distance, z + step}),
                     d = add_vertex(mesh, {x + step, distance, z + step});
      add_facet(mesh, a, b, d);
      add_facet(mesh, a, d, c);
    }
  weld(mesh);
}

/// Facets all round the apex, most of them with vertices before and behind it.
inline FacetMesh surrounding_soup(Random& random, int count, std::int32_t size) {
  FacetMesh mesh;
  for (int k = 0; k < count; ++k) {
    VertexId v[3];
    for (VertexId& id : v)
      id = add_vertex(
          mesh, {uniform(random, -size, size), uniform(random, -size, size), uniform(random, -size, size)});
    add_facet(mesh, v[0], v[1], v[2]);
  }
  weld(mesh);
  return mesh;
}

struct Scene {
  const char* name;
  FacetMesh mesh;
  TubeSet tubes;
};

/// One scene of each kind that a visibility algorithm may stumble over; small enough for slow oracles.
inline std::vector<Scene> stumbling_blocks(std::uint64_t seed) {
  Random random(seed);
  std::vector<Scene> scenes;
  const auto add = [&](const char* name, FacetMesh mesh, TubeSet tubes) {
    scenes.push_back({name, std::move(mesh), std::move(tubes)});
  };
  const auto number = [&](int lo, int hi) { return uniform(random, lo, hi); };
  const auto jitter = [&](std::int32_t size) {
    return GridPoint{number(-size, size), number(-size, size), number(-size, size)};
  };

  add("soup of facets that cut each other", random_soup(random, number(5, 30), 1000000, 500000),
      forward_tubes(jitter(50000), 2, 2, 60, 50));
  add("soup over the whole coordinate range", surrounding_soup(random, number(5, 20), 1 << 29),
      forward_tubes(jitter(1 << 29), 2, 1, 110, 90));
  add("rough terrain", rough_terrain(random, 6, 20000000, -3000000, 700000),
      forward_tubes(jitter(1000), 3, 1, 50, 30, 15));
  add("facets all round the apex", surrounding_soup(random, number(8, 25), 1000),
      forward_tubes(jitter(300), 2, 2, 150, 140));
  add("tiny grid", random_soup(random, number(6, 20), 6, 3), lattice_tubes({0, 0, 0}, -2, -2, 4, 4, 6));
  add("tiny grid all round the apex", surrounding_soup(random, number(6, 16), 2),
      lattice_tubes({0, 0, 0}, -1, -1, 2, 2, 1));

  FacetMesh solids;
  add_box(solids, {number(-300, 300), 3000, number(-300, 300)}, 600);
  add_octahedron(solids, {number(-900, 900), 3000 + number(-900, 900), number(-900, 900)}, 1000);
  add("octahedron through a cube", solids, lattice_tubes(jitter(100), -2, -2, 4, 4, 4));
  FacetMesh boxes;
  add_box(boxes, {0, 4, 0}, 2);
  add_box(boxes, {number(-1, 1), 3, number(-1, 1)}, 1);
  add("boxes with faces in common", boxes, lattice_tubes({0, 0, 0}, -2, -2, 4, 4, 2));

  FacetMesh copies = random_soup(random, 8, 1000000, 500000);
  duplicate_facets(random, copies, false);
  duplicate_facets(random, copies, true);
  add("coincident facets", copies, forward_tubes({0, 0, 0}, 2, 1, 70, 50));
  FacetMesh plates;
  add_plate(plates, 12, 4, 4, number(0, 1) == 1);
  add_plate(plates, 12, 3, 6, false);
  add_plate(plates, 9, 2, 2, true);
  add("coplanar plates with T-junctions, edges and vertices on walls", plates,
      lattice_tubes({0, 0, 0}, -2, -2, 4, 4, 3));
  FacetMesh leaning;
  add_plate(leaning, 8, 4, 2, true);
  for (GridPoint& p : leaning.vertices) p.y += p.x % 3 + number(0, 1) * (p.z % 2);
  add_box(leaning, {number(-2, 2), 8, number(-2, 2)}, 2);
  add("leaning plates sunk in a box", leaning, lattice_tubes({0, 0, 0}, -3, -3, 3, 3, 4));
  return scenes;
}

}  // namespace tubefoot::test
