// SPDX-License-Identifier: GPL-3.0-or-later
// Tests shadow borders: the closed forms of a square plate above a plane.
#include "geometry/footprints/shadow_borders.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>

#include "fixtures/geometry/coverage_oracle.hpp"

namespace tubefoot::test {
namespace {

std::vector<ShadowBorder> borders_of(const FacetMesh& mesh, const TubeSet& tubes) {
  return shadow_borders(mesh, tubes, look(mesh, tubes, 0).tx.seen);
}

TEST(ShadowBorders, OfAPlateAboveAPlaneAreItsCentralProjection) {
  constexpr double top = 1000, height = 400, half = 100;
  FacetMesh mesh;
  add_square(mesh, 4000, 0);
  const GridPoint apex{30, -20, 1000};
  for (const std::vector<std::int32_t>& x :
       {std::vector<std::int32_t>{-800, 900}, std::vector<std::int32_t>{-800, -31, 0, 45, 120, 900}}) {
    const TubeSet tubes = down_tubes(apex, x, {-700, 10, 650}, 1000);
    EXPECT_TRUE(borders_of(mesh, tubes).empty());
    FacetMesh with_plate = mesh;
    add_square(with_plate, 100, 400);
    double length = 0;
    std::map<int, double> length_by_sine;  // in units of 1e-6
    for (const ShadowBorder& border : borders_of(with_plate, tubes)) {
      length += border.length;
      EXPECT_NEAR(border.beyond_edge / (border.to_edge + border.beyond_edge), height / top, 1e-12);
      length_by_sine[int(std::lround(border.sine * 1e6))] += border.length;
    }
    EXPECT_NEAR(length, 8 * half * top / (top - height), 1e-9 * length);
    // The plane through an edge at the horizontal distance d from the apex.
    for (const double d : {half - 30, half + 30, half - 20, half + 20})
      EXPECT_NEAR(length_by_sine[int(std::lround(1e6 * (top - height) / std::hypot(top - height, d)))],
                  2 * half * top / (top - height), 1e-6);
  }
}

// The shadows of vertical edges lead away from the foot point of the apex. The planes of these edges divide
// the visible facet on the other side too, where there is no shadow.
TEST(ShadowBorders, OfAWallEndAtItsFoot) {
  FacetMesh mesh;
  add_square(mesh, 4000, 0);
  const auto corner = [&](std::int32_t x, std::int32_t z) {
    mesh.vertices.push_back({x, 100, z});
    return static_cast<VertexId>(mesh.vertices.size() - 1);
  };
  const VertexId a = corner(-200, 0), b = corner(200, 0), c = corner(200, 500), d = corner(-200, 500);
  for (const std::array<VertexId, 3>& facet : {std::array{a, b, c}, std::array{a, c, d}}) {
    mesh.facets.push_back(facet);
    mesh.material.push_back(0);
    mesh.component.push_back(0);
  }
  // The shadow is a trapezium, twice as far from the foot point of the apex as the wall.
  double length = 0;
  for (const ShadowBorder& border :
       borders_of(mesh, down_tubes({0, 0, 1000}, {-900, 30, 900}, {-700, 650}, 1000)))
    length += border.length;
  EXPECT_NEAR(length, 800 + 2 * std::hypot(200, 100), 1e-6);
}

TEST(ShadowBorders, AreNeitherContactsNorSides) {
  FacetMesh mesh;
  add_square(mesh, 4000, 0);
  add_square(mesh, 100, 0);  // lies on the plane
  EXPECT_TRUE(borders_of(mesh, down_tubes({0, 0, 1000}, {-800, 900}, {-700, 650}, 1000)).empty());
}

}  // namespace
}  // namespace tubefoot::test
