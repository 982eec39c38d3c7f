// SPDX-License-Identifier: GPL-3.0-or-later
// Adversarial cases with facets of difficult shape or at small distances: slivers, needles, T-junctions,
// coincident facets, and many close layers.
#include <cmath>
#include <numbers>

#include "validation/case.hpp"
#include "validation/mesh_pieces.hpp"

namespace tubefoot::atlas {
namespace {

/// Points of a tilted plane, at integer coordinates only. No coordinate along its edges is a round number.
/// All points are exactly coplanar, and exactly collinear if a or b is the same.
GridPoint tilted(std::int32_t a, std::int32_t b) {
  return {-250000013 + 7368787 * a + 1299827 * b, 400000009 + 2750161 * a - 1500451 * b,
          -240000011 - 611953 * a + 6495139 * b};
}

TubeSet wide_tube(std::int32_t half) {
  return parallelogram_tubes({0, 0, 0}, {-half, 800000011, -half}, {2 * half, 0, 0}, {0, 0, 2 * half});
}

}  // namespace

Case slivers(Size size) {
  Random random(201);
  Case c;
  c.name = "slivers";
  c.title = "slivers of aspect 1e8";
  c.why =
      "Crossing threads 256 m long and 2 micrometres wide. Their normals are small differences of large "
      "products.";
  constexpr std::int32_t half = 1 << 27;
  const auto depth = [&] { return uniform(random, 90, 110); };
  const int threads = size == Size::page ? 24 : 8;
  for (int k = 0; k < threads; ++k) {
    const std::int32_t at = (2 * k - threads) * 50 / threads;
    add_facet(c.mesh, GridPoint{-half, depth(), at}, GridPoint{half, depth(), at + 2},
              GridPoint{half, depth(), at});
    add_facet(c.mesh, GridPoint{at, depth(), -half}, GridPoint{at + 2, depth(), half},
              GridPoint{at, depth(), half});
  }
  weld(c.mesh);
  c.tubes = parallelogram_tubes({0, 0, 0}, {-500000003, 1000000007, -500000003}, {1000000006, 0, 0},
                                {0, 0, 1000000006});
  return c;
}

Case needle_tube(Size size) {
  Random random(202);
  Case c;
  c.name = "needle-tube";
  c.title = "needle-thin tube";
  c.why =
      "The four rays of the tube differ by 3e-8 rad, and so do all directions in it. Float has a single ray "
      "there.";
  const GridPoint centre{268447801, 536877701, -134213407};
  const auto point = [&] {
    return GridPoint{centre.x + uniform(random, -20, 20), centre.y + uniform(random, -20, 20),
                     centre.z + uniform(random, -20, 20)};
  };
  for (int k = 0; k < (size == Size::page ? 16 : 8); ++k) {
    const GridPoint p = point(), q = point(), r = point();
    add_facet(c.mesh, p, q, r);
  }
  weld(c.mesh);
  c.tubes = parallelogram_tubes({0, 0, 0}, {centre.x - 8, centre.y, centre.z - 8}, {16, 0, 0}, {0, 0, 16});
  return c;
}

Case t_junctions(Size size) {
  Random random(203);
  Case c;
  c.name = "t-junctions";
  c.title = "T-junctions";
  c.why =
      "Adjacent columns of a plate have different heights of their cuts. The vertices lie on the edge of the "
      "neighbour, but only in exact arithmetic. An engine that rounds sees the wall behind through gaps, or "
      "facets twice.";
  const int n = size == Size::page ? 12 : 5;
  for (int i = 0; i < n; ++i) {
    const int first = 70 * i / n, last = 70 * (i + 1) / n;
    std::int32_t b = 0;
    while (b < 70) {
      const std::int32_t top = std::min(70, b + uniform(random, 3, 11));
      const GridPoint p = tilted(first, b), q = tilted(last, b), r = tilted(last, top),
                      s = tilted(first, top);
      add_facet(c.mesh, p, q, r);
      add_facet(c.mesh, p, r, s);
      b = top;
    }
  }
  const GridPoint p{-900000007, 1000000007, -900000007}, q{900000011, 1000000007, -900000007},
      r{900000011, 1000000007, 900000011}, s{-900000007, 1000000007, 900000011};
  add_facet(c.mesh, p, q, r);
  add_facet(c.mesh, p, r, s);
  weld(c.mesh);
  c.tubes = wide_tube(500000003);
  return c;
}

Case coincident_facets(Size size) {
  Random random(204);
  Case c;
  c.name = "coincident-facets";
  c.title = "coincident facets";
  c.why =
      "Overlapping facets lie in one tilted plane. By rule the facet with the smaller vertices is visible, "
      "and only an exact zero triggers the rule. The rule also applies to engines without a rule, whose "
      "choice is arbitrary and changes with the direction of the ray.";
  const auto point = [&] { return tilted(uniform(random, -4, 74), uniform(random, -4, 74)); };
  for (int k = 0; k < (size == Size::page ? 40 : 16); ++k) {
    const GridPoint p = point(), q = point(), r = point();
    add_facet(c.mesh, p, q, r);
    if (k % 4 == 0) add_facet(c.mesh, q, r, p);
  }
  weld(c.mesh);
  c.tubes = wide_tube(500000003);
  return c;
}

Case layers_one_unit_apart(Size size) {
  Random random(205);
  Case c;
  c.name = "layers-one-unit-apart";
  c.title = "layers 1 unit apart";
  c.why =
      "Sheets of tilted facets, 256 m away, each a micrometre behind the previous one. In float, all of them "
      "are one sheet.";
  for (int layer = 0; layer < (size == Size::page ? 12 : 5); ++layer)
    for (int k = 0; k < 5; ++k) {
      const auto point = [&] {
        const std::int32_t x = 8 * uniform(random, -1 << 24, 1 << 24),
                           z = 8 * uniform(random, -1 << 24, 1 << 24);
        return GridPoint{x, (1 << 28) + layer + x / 4 + 3 * (z / 8), z};
      };
      const GridPoint p = point(), q = point(), r = point();
      add_facet(c.mesh, p, q, r);
    }
  c.tubes = wide_tube(300000007);
  return c;
}

Case thousands_of_layers(Size size) {
  Random random(206);
  Case c;
  c.name = "thousands-of-layers";
  c.title = "many thousand layers";
  c.why =
      "A stack of rotated triangles, each 3 units behind the previous one. Nearly all are hidden, but none "
      "by a single facet. The remainder of a facet after many cuts determines the next cut.";
  const int layers = size == Size::page ? 4000 : 150;
  for (int k = 0; k < layers; ++k) {
    const double radius = 1.5e8 + uniform(random, 0, 50000000), turn = uniform(random, 0, 1 << 20) * 0x1p-20;
    const auto corner = [&](int i) {
      const double angle = 2 * std::numbers::pi * (turn + i / 3.0);
      const auto x = static_cast<std::int32_t>(radius * std::cos(angle)) / 8 * 8,
                 z = static_cast<std::int32_t>(radius * std::sin(angle)) / 8 * 8;
      return GridPoint{x, (1 << 28) + 3 * k + x / 4 + 3 * (z / 8), z};
    };
    add_facet(c.mesh, corner(0), corner(1), corner(2));
  }
  c.tubes = wide_tube(450000011);
  return c;
}

Case whole_coordinate_range(Size size) {
  Random random(207);
  Case c;
  c.name = "whole-coordinate-range";
  c.title = "facets over the whole coordinate range";
  c.why =
      "Facets as large as the grid that intersect each other: 30-bit numbers in determinants of degree 9.";
  constexpr std::int32_t reach = (1 << 29) - 1;
  for (int k = 0; k < (size == Size::page ? 40 : 12); ++k) {
    const auto point = [&] {
      return GridPoint{uniform(random, -reach, reach), uniform(random, reach / 16, reach),
                       uniform(random, -reach, reach)};
    };
    const GridPoint p = point(), q = point(), r = point();
    add_facet(c.mesh, p, q, r);
  }
  c.tubes = wide_tube(700000001);
  return c;
}

}  // namespace tubefoot::atlas
