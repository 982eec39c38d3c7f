// SPDX-License-Identifier: GPL-3.0-or-later
// Adversarial cases with the apex and the walls of tubes in special positions: near planes of facets, along
// edges, on vertices and on faces.
#include <array>
#include <cmath>

#include "validation/case.hpp"
#include "validation/mesh_pieces.hpp"

namespace tubefoot::atlas {
namespace {

/// Rays of a lattice with large coordinates that no power of two divides. Their products do not fit in a
/// double.
constexpr std::int32_t lattice_step = 104729, lattice_depth = 299993;

GridPoint on_lattice(std::int32_t i, std::int32_t j, std::int32_t times) {
  return {i * lattice_step * times, lattice_depth * times, j * lattice_step * times};
}

/// Four tubes whose walls pass through the rays of even index of the lattice.
TubeSet lattice_tubes() {
  constexpr std::int32_t step = 2 * lattice_step;
  return parallelogram_tubes({0, 0, 0}, {-step, lattice_depth, -step}, {step, 0, 0}, {0, 0, step}, 2, 2);
}

/// A rough sheet all around the origin, so that a facet can be moved below the apex.
FacetMesh surroundings(Random& random, int n) {
  constexpr std::int32_t cell = 1 << 22;
  FacetMesh mesh;
  add_sheet(mesh, n, n, [&](int u, int v) {
    const std::int32_t away = (u - n / 2) * (u - n / 2) + (v - n / 2) * (v - n / 2);
    return GridPoint{(u - n / 2) * cell + uniform(random, -cell / 3, cell / 3),
                     (v - n / 2) * cell + uniform(random, -cell / 3, cell / 3),
                     away * cell / (4 * n) + uniform(random, -cell / 2, cell / 2)};
  });
  return mesh;
}

TubeSet level_tube(GridPoint apex) {
  return parallelogram_tubes(apex, {-500000003, 700000001, -250000007}, {1000000006, 0, 0},
                             {0, 0, 500000014});
}

}  // namespace

Case apex_nearly_in_planes(Size size) {
  Random random(101);
  Case c;
  c.name = "apex-nearly-in-planes";
  c.title = "apex nearly in planes";
  c.why =
      "Planes of facets 500 m long pass the apex at a distance of a few micrometres. The side of the apex, "
      "and the order of two facets, depend on differences of nearly equal numbers.";
  const auto point = [&] {
    const double y = std::exp2(3 + 26 * (uniform(random, 0, 1 << 20) * 0x1p-20));
    const double x = y * (uniform(random, -1 << 20, 1 << 20) * 0x1p-20);
    return GridPoint{static_cast<std::int32_t>(x), static_cast<std::int32_t>(y), uniform(random, -3, 3)};
  };
  for (int k = 0; k < (size == Size::page ? 48 : 16); ++k) {
    const GridPoint p = point(), q = point(), r = point();
    add_facet(c.mesh, p, q, r);
  }
  weld(c.mesh);
  c.tubes = parallelogram_tubes({0, 0, 0}, {-1 << 28, 1 << 29, -1 << 26}, {1 << 29, 0, 0}, {0, 0, 1 << 27});
  return c;
}

Case walls_along_edges(Size size) {
  Random random(102);
  Case c;
  c.name = "walls-along-edges";
  c.title = "tube walls along mesh edges";
  c.why =
      "Every edge of two crossing sheets lies in a plane through lattice rays, and tube walls are such "
      "planes. Signs that should be 0 are rounding noise.";
  for (int sheet = 0; sheet < (size == Size::page ? 3 : 2); ++sheet)
    add_sheet(c.mesh, 8, 8,
              [&](int u, int v) { return on_lattice(u - 4, v - 4, uniform(random, 700, 2400)); });
  c.tubes = lattice_tubes();
  c.columns = 2;
  return c;
}

Case vertices_on_walls(Size size) {
  Random random(103);
  Case c;
  c.name = "vertices-on-walls";
  c.title = "vertices on tube walls";
  c.why =
      "All vertices lie on planes of walls, and edges cross the walls there. Inside, outside and on the wall "
      "are one unit apart.";
  const auto point = [&] {
    const std::int32_t wall = 2 * uniform(random, -1, 1), along = uniform(random, -30, 30),
                       times = uniform(random, 100, 240);
    const std::int32_t exact = lattice_step * wall * times, free = lattice_step / 10 * along * times;
    return random() % 2 ? GridPoint{exact, lattice_depth * times, free}
                        : GridPoint{free, lattice_depth * times, exact};
  };
  for (int k = 0; k < (size == Size::page ? 60 : 24); ++k) {
    const GridPoint p = point(), q = point(), r = point();
    add_facet(c.mesh, p, q, r);
  }
  weld(c.mesh);
  c.tubes = lattice_tubes();
  c.columns = 2;
  return c;
}

Case apex_on_vertex(Size size) {
  Random random(104);
  Case c;
  c.name = "apex-on-vertex";
  c.title = "apex on a vertex";
  c.why =
      "The facets of this vertex subtend no solid angle, because their planes contain the apex. A ray engine "
      "hits them at distance 0.";
  const int n = size == Size::page ? 24 : 10;
  c.mesh = surroundings(random, n);
  const GridPoint apex = c.mesh.vertices[static_cast<std::size_t>(n / 2 * (n + 1) + n / 2)];
  c.tubes = level_tube(apex);
  return c;
}

Case apex_on_edge(Size size) {
  Random random(105);
  Case c;
  c.name = "apex-on-edge";
  c.title = "apex on an edge";
  c.why =
      "As on a vertex, but no coordinate is shared, so a computation must find that the planes contain the "
      "apex.";
  const int n = size == Size::page ? 24 : 10;
  c.mesh = surroundings(random, n);
  const auto a = static_cast<std::size_t>(n / 2 * (n + 1) + n / 2);
  const GridPoint p = c.mesh.vertices[a];
  GridPoint& q = c.mesh.vertices[a + 1];
  for (const auto coordinate : {&GridPoint::x, &GridPoint::y, &GridPoint::z})
    q.*coordinate += (q.*coordinate - p.*coordinate) % 2;
  c.tubes = level_tube({p.x + (q.x - p.x) / 2, p.y + (q.y - p.y) / 2, p.z + (q.z - p.z) / 2});
  return c;
}

Case apex_on_face(Size size) {
  Random random(106);
  Case c;
  c.name = "apex-on-face";
  c.title = "apex on a face";
  c.why =
      "As on an edge, but inside one facet. After rounding to float, the apex is above or below the facet by "
      "chance.";
  const int n = size == Size::page ? 24 : 10;
  c.mesh = surroundings(random, n);
  const auto a = static_cast<std::size_t>(n / 2 * (n + 1) + n / 2);
  const GridPoint p = c.mesh.vertices[a], q = c.mesh.vertices[a + 1];
  GridPoint& r = c.mesh.vertices[a + static_cast<std::size_t>(n) + 2];
  GridPoint apex;
  for (const auto coordinate : {&GridPoint::x, &GridPoint::y, &GridPoint::z}) {
    r.*coordinate -= (p.*coordinate + q.*coordinate + r.*coordinate) % 3;
    apex.*coordinate = (p.*coordinate + q.*coordinate + r.*coordinate) / 3;
  }
  c.tubes = level_tube(apex);
  return c;
}

Case across_the_horizon(Size size) {
  Random random(107);
  Case c;
  c.name = "across-the-horizon";
  c.title = "facets that reach behind the apex";
  c.why =
      "In a projection to a picture, such facets become two unbounded parts. Clipping before the projection "
      "causes rounding.";
  constexpr std::int32_t reach = (1 << 29) - 1;
  const auto point = [&] {
    return GridPoint{uniform(random, -reach, reach), uniform(random, -reach, reach),
                     uniform(random, -reach, reach)};
  };
  while (c.mesh.facets.size() < (size == Size::page ? 40u : 14u)) {
    const std::array<GridPoint, 3> p{point(), point(), point()};
    const int behind = (p[0].y < 0) + (p[1].y < 0) + (p[2].y < 0);
    if (behind == 1 || behind == 2) add_facet(c.mesh, p[0], p[1], p[2]);
  }
  c.tubes = parallelogram_tubes({12345, -6789, 1011}, {-800000011, 300000007, -600000001}, {800000011, 0, 0},
                                {0, 0, 600000001}, 2, 2);
  c.columns = 2;
  return c;
}

Case tiny_lattice(Size size) {
  Random random(108);
  Case c;
  c.name = "tiny-lattice";
  c.title = "everything on a lattice of 7 units";
  c.why =
      "On a few lattice points every special position occurs at the same time, also coincident facets and "
      "walls through vertices. The numbers are so small that they are exact in any arithmetic.";
  const auto point = [&] {
    return GridPoint{uniform(random, -3, 3), uniform(random, 3, 9), uniform(random, -3, 3)};
  };
  for (int k = 0; k < (size == Size::page ? 40 : 16); ++k) {
    const GridPoint p = point(), q = point(), r = point();
    add_facet(c.mesh, p, q, r);
  }
  weld(c.mesh);
  c.tubes = parallelogram_tubes({0, 0, 0}, {-2, 4, -2}, {2, 0, 0}, {0, 0, 2}, 2, 2);
  c.columns = 2;
  c.grid_exponent = 0;
  return c;
}

}  // namespace tubefoot::atlas
