// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "scenes_for_tests.hpp"

// Meshes of some hundred facets with shared edges, in layers before and through each other: what a kernel
// that reasons about connected surfaces may stumble over.
namespace tubefoot::test {

/// An octahedron whose facets were split in four `times` times, vertices on a sphere (to the grid).
inline void add_sphere(FacetMesh& mesh, GridPoint centre, double radius, int times) {
  FacetMesh sphere;
  add_octahedron(sphere, {0, 0, 0}, static_cast<std::int32_t>(radius));
  for (int k = 0; k < times; ++k) {
    std::map<std::pair<VertexId, VertexId>, VertexId> middles;
    const auto middle = [&](VertexId a, VertexId b) {
      const auto [place, is_new] = middles.try_emplace(std::minmax(a, b), 0);
      if (is_new) {
        const GridPoint p = sphere.vertices[a], q = sphere.vertices[b];
        const double x = double(p.x) + q.x, y = double(p.y) + q.y, z = double(p.z) + q.z;
        const double scale = radius / std::sqrt(x * x + y * y + z * z);
        place->second = add_vertex(sphere, {static_cast<std::int32_t>(std::lround(x * scale)),
                                            static_cast<std::int32_t>(std::lround(y * scale)),
                                            static_cast<std::int32_t>(std::lround(z * scale))});
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

/// A sheet of 2 nu nv facets through the points at(u, v), u = 0..nu, v = 0..nv.
template <class At>
void add_sheet(FacetMesh& mesh, int nu, int nv, const At& at) {
  const auto first = static_cast<VertexId>(mesh.vertices.size());
  for (int v = 0; v <= nv; ++v)
    for (int u = 0; u <= nu; ++u) add_vertex(mesh, at(u, v));
  for (int v = 0; v < nv; ++v)
    for (int u = 0; u < nu; ++u) {
      const auto a = first + static_cast<VertexId>(v * (nu + 1) + u), c = a + static_cast<VertexId>(nu) + 1;
      add_facet(mesh, a, a + 1, c + 1);
      add_facet(mesh, a, c + 1, c);
    }
}

inline std::vector<Scene> layered_scenes(std::uint64_t seed) {
  Random random(seed);
  const auto number = [&](int lo, int hi) { return uniform(random, lo, hi); };
  const auto rounded = [](double x) { return static_cast<std::int32_t>(std::lround(x)); };
  std::vector<Scene> scenes;

  FacetMesh curtains;  // sheets across the line of sight, one behind the other, bulging into each other
  for (int sheet = 0; sheet < 4; ++sheet)
    add_sheet(curtains, 9, 9, [&](int u, int v) {
      return GridPoint{(u - 4) * 900 + number(-200, 200),
                       8000 + 1000 * sheet + number(-900, 900) * (sheet % 2),
                       (v - 4) * 900 + number(-200, 200)};
    });
  scenes.push_back(
      {"curtains", curtains, forward_tubes({number(-900, 900), 0, number(-900, 900)}, 2, 1, 36, 30)});

  FacetMesh beds = rough_terrain(random, 12, 20000000, -3000000, 500000);
  add_sheet(beds, 12, 12, [&](int u, int v) {
    return GridPoint{(u - 6) * 1600000 + 77, v * 1700000,
                     -3300000 + (u + v) * 20000 + number(-300000, 300000)};
  });
  scenes.push_back({"two beds that cross", beds, forward_tubes({number(-9, 9), -5, 0}, 2, 2, 40, 30, 22)});

  FacetMesh spheres;
  add_sphere(spheres, {0, 30000, 0}, 9000, 3);
  add_sphere(spheres, {number(-9000, 9000), 30000 + number(-9000, 9000), number(-9000, 9000)}, 7000, 2);
  add_sphere(spheres, {0, 30000, 0}, 5000, 2);
  scenes.push_back(
      {"spheres in and through each other", spheres, forward_tubes({0, number(0, 9), 0}, 2, 2, 44, 40)});
  scenes.push_back(
      {"inside the spheres", spheres, forward_tubes({number(-999, 999), 30000, 0}, 3, 1, 170, 120)});

  FacetMesh spiral;  // no fold, no border inside the tube, and yet it covers most directions several times
  const int turns = number(2, 3);
  add_sheet(spiral, 12 * turns, 3, [&](int u, int v) {
    const double angle = u * std::acos(-1.0) / 6, r = 200 + 1500 * v;
    return GridPoint{rounded(r * std::cos(angle)), 6000 + u * 60 + number(-9, 9),
                     rounded(r * std::sin(angle))};
  });
  scenes.push_back(
      {"spiral ramp along its axis", spiral, forward_tubes({number(-300, 300), 0, 0}, 3, 3, 30, 30)});

  FacetMesh pleats;  // folds, some of them so deep that the sheet runs through itself
  add_sheet(pleats, 16, 6, [&](int u, int v) {
    return GridPoint{(u % 4 < 2 ? u : u - 3) * 700 - 5000 + number(-300, 300),
                     9000 + number(-600, 600) + 300 * u, (v - 3) * 1300};
  });
  scenes.push_back({"pleats", pleats, forward_tubes({0, 0, number(-500, 500)}, 2, 2, 40, 30)});

  FacetMesh fins;  // three and four facets on an edge, facets twice, facets missing
  add_sheet(fins, 10, 10, [&](int u, int v) {
    return GridPoint{(u - 5) * 800, 9000 + number(-300, 300), (v - 5) * 800};
  });
  const std::size_t sheet_facets = fins.facets.size();
  for (int k = 0; k < 25; ++k) {
    const auto facet = fins.facets[random() % sheet_facets];
    switch (k % 3) {
      case 0:
        add_facet(fins, facet[0], facet[1],
                  add_vertex(fins, {number(-3000, 3000), number(6000, 12000), number(-3000, 3000)}));
        break;
      case 1:
        add_facet(fins, facet[1], facet[0], facet[2]);
        break;
      default:
        fins.facets[random() % sheet_facets] = facet;
    }
  }
  scenes.push_back(
      {"fins, holes and doubled facets", fins, forward_tubes({number(-99, 99), 0, 0}, 2, 2, 40, 40)});

  FacetMesh steps;  // integer steps on a lattice: walls seen edge-on, edges in line, rays through vertices
  add_sheet(steps, 12, 12, [&](int u, int v) { return GridPoint{u - 6, 12 + number(0, 2), v - 6}; });
  add_sheet(steps, 6, 6, [&](int u, int v) { return GridPoint{2 * u - 6, 12 + number(-2, 1), 2 * v - 6}; });
  scenes.push_back({"steps on a lattice", steps, lattice_tubes({0, 0, 0}, -1, -1, 2, 2, 3)});
  return scenes;
}

/// Every kind of scene.
inline std::vector<Scene> all_scenes(std::uint64_t seed) {
  std::vector<Scene> scenes = stumbling_blocks(seed);
  for (Scene& scene : layered_scenes(seed)) scenes.push_back(std::move(scene));
  return scenes;
}

}  // namespace tubefoot::test
