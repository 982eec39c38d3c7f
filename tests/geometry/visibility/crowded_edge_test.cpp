// SPDX-License-Identifier: GPL-3.0-or-later
// Tests very many facets at one edge, as faulty exporters and fans of wires make them.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "fixtures/geometry/grid_scenes.hpp"
#include "fixtures/geometry/looks.hpp"
#include "geometry/visibility/closure.hpp"

namespace tubefoot {
namespace {

using namespace test;

/// A book across the view, with its pages all around the spine. With `one_spine` the pages share the
/// vertices of the spine. Otherwise each page has its own vertices at the same positions, and is not
/// connected to the others.
FacetMesh book(int pages, bool one_spine) {
  constexpr double radius = 200000;
  FacetMesh mesh;
  const auto spine = [&mesh] {
    const VertexId first = add_vertex(mesh, {-300000, 1000000, 10000});
    add_vertex(mesh, {280000, 1000000, 20000});
    return first;
  };
  VertexId ends = spine();
  for (int page = 0; page < pages; ++page) {
    if (!one_spine && page > 0) ends = spine();
    const double angle = 2 * std::numbers::pi * page / pages;
    const VertexId rim = add_vertex(
        mesh, {page * 7 % 1000, 1000000 + static_cast<std::int32_t>(std::lround(radius * std::cos(angle))),
               static_cast<std::int32_t>(std::lround(radius * std::sin(angle)))});
    add_facet(mesh, ends, ends + 1, rim);
  }
  return mesh;
}

struct Book {
  TubeAudit audit;
  std::size_t occluders = 0;
};

Book open_book(const FacetMesh& mesh, Arithmetic arithmetic) {
  const TubeSet tubes = forward_tubes({0, 0, 0}, 1, 1, 40, 30);
  const SceneTree tree(mesh);
  VisibilityScratch scratch;
  TubeVisibility seen;
  see(mesh, tree, tubes, 0, with(arithmetic), scratch, seen);
  return {audit(mesh, tubes, 0, seen, 1), seen.occluders.size()};
}

TEST(CrowdedEdge, WhatIsSeenIsWhatIsSeenOfPagesThatShareNothing) {
  constexpr int pages = 150;
  const Book shared = open_book(book(pages, true), Arithmetic::fixed),
             apart = open_book(book(pages, false), Arithmetic::fixed);
  EXPECT_TRUE(shared.audit.closes);
  EXPECT_TRUE(apart.audit.closes);
  EXPECT_GT(shared.audit.facets, 20u);
  EXPECT_EQ(shared.audit.facets, apart.audit.facets);
  EXPECT_EQ(shared.audit.hash, apart.audit.hash);
}

// Law V2.
TEST(CrowdedEdge, EveryArithmeticSeesTheSame) {
  const FacetMesh mesh = book(60, true);
  const Book fixed = open_book(mesh, Arithmetic::fixed);
  for (const Arithmetic other : {Arithmetic::filtered, Arithmetic::rational}) {
    const Book seen = open_book(mesh, other);
    EXPECT_TRUE(seen.audit.closes);
    EXPECT_EQ(seen.audit.hash, fixed.audit.hash);
  }
}

TEST(CrowdedEdge, APageIsCutByAFewOthersAndNotByAll) {
  const std::size_t few = open_book(book(100, true), Arithmetic::fixed).occluders,
                    many = open_book(book(200, true), Arithmetic::fixed).occluders;
  EXPECT_LT(many, 5 * few / 2) << "cuts grow with the pages, not with their square";
}

}  // namespace
}  // namespace tubefoot
