// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "fixtures/geometry/grid_scenes.hpp"
#include "geometry/search/vertical_line.hpp"

namespace tubefoot {
namespace {

using namespace test;
using Part = FacetContact::Part;

std::optional<Part> contact(const FacetMesh& mesh, GridPoint point) {
  const SceneTree tree(mesh);
  std::vector<FacetId> near;
  facets_near_vertical(tree, point, near);
  const auto found = contact_at(mesh, near, point);
  return found ? std::optional(found->part) : std::nullopt;
}

// Law F3.
TEST(Contact, IsFoundToTheGridUnit) {
  // As large as the grid allows: products of three coordinates have 94 bits.
  constexpr std::int32_t far = 1 << 29;
  for (const std::array<GridPoint, 3>& corners :
       {std::array<GridPoint, 3>{{{-far, -far, -far}, {far, -far, far}, {-far, far, far}}},
        {{{-far, -far, 8}, {far, -far, 8}, {-far, far, 8}}},
        {{{4, -far, -far}, {4, far, -far}, {4, -far, far}}}}) {
    FacetMesh mesh;
    for (const GridPoint& p : corners) add_vertex(mesh, p);
    add_facet(mesh, 0, 1, 2);
    const auto between = [&](std::int64_t a, std::int64_t b, std::int64_t c) {
      const auto mean = [=](std::int64_t x, std::int64_t y, std::int64_t z) {
        return static_cast<std::int32_t>((a * x + b * y + c * z) / (a + b + c));
      };
      return GridPoint{mean(corners[0].x, corners[1].x, corners[2].x),
                       mean(corners[0].y, corners[1].y, corners[2].y),
                       mean(corners[0].z, corners[1].z, corners[2].z)};
    };
    EXPECT_EQ(contact(mesh, corners[1]), Part::vertex);
    EXPECT_EQ(contact(mesh, between(1, 0, 1)), Part::edge);
    EXPECT_EQ(contact(mesh, between(1, 1, 0)), Part::edge);
    EXPECT_EQ(contact(mesh, between(2, 1, 1)), Part::facet);
    const GridPoint beyond = between(-1, 1, 2), inside = between(2, 1, 1);
    EXPECT_EQ(contact(mesh, beyond), std::nullopt) << "in the plane, beyond an edge";
    for (const GridPoint& step : {GridPoint{1, 1, 1}, {-1, -1, -1}})
      EXPECT_EQ(contact(mesh, {inside.x + step.x, inside.y + step.y, inside.z + step.z}), std::nullopt);
  }
}

TEST(Contact, FacetsWithoutAreaAreNothingToLieOn) {
  FacetMesh mesh;
  for (const GridPoint& p : {GridPoint{0, 0, 0}, {4, 4, 4}, {8, 8, 8}}) add_vertex(mesh, p);
  add_facet(mesh, 0, 1, 2);
  EXPECT_EQ(contact(mesh, {4, 4, 4}), std::nullopt);
}

}  // namespace
}  // namespace tubefoot
