// SPDX-License-Identifier: GPL-3.0-or-later
// Adversarial cases of ordinary scenes: interpenetrating surfaces, large coordinate offsets (UTM, ECEF),
// small facets and terrain at grazing angles.
#include <algorithm>

#include "validation/case.hpp"
#include "validation/mesh_pieces.hpp"

namespace tubefoot::atlas {
namespace {

constexpr std::int32_t metre = 1 << 20, millimetre = metre / 1000;

/// A seabed of 20 m x 20 m with a partly buried sphere and a ramp, seen from 3 m above one edge. The ramp
/// consists of coplanar panels that meet in T-junctions.
void add_harbour_seabed(Case& c, std::uint64_t seed, Size size) {
  Random random(seed);
  const int n = size == Size::page ? 40 : 12;
  add_seabed(random, c.mesh, n, 20 * metre, -3 * metre, metre / 3, 20 * 20 * metre / n / 100);
  add_sphere(c.mesh, {metre, 8 * metre, -3 * metre}, 3 * metre / 2, size == Size::page ? 3 : 2);
  const auto ramp = [](int a, int b) {
    return GridPoint{-4 * metre + 33331 * a + 3007 * b, 6 * metre + 9973 * a + 71993 * b,
                     -3 * metre + 7919 * a + 21001 * b};
  };
  for (int column = 0; column < 8; ++column)
    for (int b = 0; b < 60;) {
      const int top = std::min(60, b + uniform(random, 5, 15)), left = 12 * column, right = left + 12;
      add_facet(c.mesh, ramp(left, b), ramp(right, b), ramp(right, top));
      add_facet(c.mesh, ramp(left, b), ramp(right, top), ramp(left, top));
      b = top;
    }
  weld(c.mesh);
  c.tubes = parallelogram_tubes({0, -2 * metre, 0}, {-375 * metre, 800 * metre, -450 * metre},
                                {750 * metre, 0, 0}, {0, 80 * metre, 400 * metre});
}

}  // namespace

Case interpenetration(Size size) {
  Case c;
  c.name = "interpenetration";
  c.title = "interpenetration along a curve";
  c.why =
      "Two spheres intersect each other and a wall. Their common curve is in no mesh, and facets that "
      "intersect have no depth order.";
  const int times = size == Size::page ? 4 : 2;
  add_sphere(c.mesh, {-100000007, 600000011, -50000017}, 240000013, times);
  add_sphere(c.mesh, {130000027, 590000003, 60000011}, 220000019, times);
  constexpr std::int32_t far = 640000033, near = 560000011, wide = 500000009;
  add_facet(c.mesh, GridPoint{-wide, far, -wide}, GridPoint{wide, near, -wide}, GridPoint{wide, near, wide});
  add_facet(c.mesh, GridPoint{-wide, far, -wide}, GridPoint{wide, near, wide}, GridPoint{-wide, far, wide});
  weld(c.mesh);
  c.tubes = parallelogram_tubes({0, 0, 0}, {-450000007, 800000011, -400000009}, {900000014, 0, 0},
                                {0, 0, 800000018});
  return c;
}

Case utm_offset(Size size) {
  Case c;
  c.name = "utm-offset";
  c.title = "scene at a UTM offset";
  c.why =
      "Float rounds a northing of 4.6e6 m to half a metre, which is the size of a cell here. An engine that "
      "does not subtract an origin sees steps.";
  add_harbour_seabed(c, 301, size);
  c.origin_m = {500123.25, 4649776.5, -31.0};
  return c;
}

Case ecef_offset(Size size) {
  Case c;
  c.name = "ecef-offset";
  c.title = "scene at an ECEF offset";
  c.why = "Earth-centred coordinates, 6.4e6 m from the origin, are like UTM but also affect the height.";
  add_harbour_seabed(c, 302, size);
  c.origin_m = {3904172.5, 711913.25, 4979471.75};
  return c;
}

Case small_facets(Size size) {
  Random random(303);
  Case c;
  c.name = "small-facets";
  c.title = "facets far smaller than a beam";
  c.why =
      "Thousands of facets lie in one tube, and most of them are partly hidden. No sampling hits all of "
      "them, and each gap between them matters.";
  const int n = size == Size::page ? 70 : 14;
  add_seabed(random, c.mesh, n, 8 * metre, -2 * metre, metre / 5, 8 * 20 * metre / n / 100);
  c.tubes = parallelogram_tubes({0, -metre, 0}, {-375 * metre, 800 * metre, -450 * metre},
                                {750 * metre, 0, 0}, {0, 80 * metre, 330 * metre});
  return c;
}

Case grazing_terrain(Size size) {
  Random random(304);
  Case c;
  c.name = "grazing-terrain";
  c.title = "grazing terrain";
  c.why =
      "A seabed of 60 m with a relief of millimetres, seen from 5 cm above it. Every facet is nearly edge-on "
      "and partly hidden, and shadows are many cells long.";
  const int n = size == Size::page ? 50 : 12;
  add_seabed(random, c.mesh, n, 60 * metre, -50 * millimetre, 8 * millimetre, 3 * millimetre);
  c.tubes = parallelogram_tubes({0, -metre / 10, 0}, {-100 * metre, 500 * metre, -3 * metre},
                                {200 * metre, 0, 0}, {0, 0, 3 * metre + metre / 4});
  return c;
}

std::vector<Case> all_cases(Size size) {
  return {apex_nearly_in_planes(size),
          slivers(size),
          needle_tube(size),
          walls_along_edges(size),
          vertices_on_walls(size),
          t_junctions(size),
          coincident_facets(size),
          layers_one_unit_apart(size),
          thousands_of_layers(size),
          across_the_horizon(size),
          apex_on_vertex(size),
          apex_on_edge(size),
          apex_on_face(size),
          interpenetration(size),
          utm_offset(size),
          ecef_offset(size),
          small_facets(size),
          grazing_terrain(size),
          whole_coordinate_range(size),
          tiny_lattice(size)};
}

}  // namespace tubefoot::atlas
