// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/arithmetic/exact_corner.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "fixtures/geometry/exact_oracles.hpp"
#include "fixtures/geometry/layered_scenes.hpp"
#include "fixtures/geometry/looks.hpp"
#include "geometry/arithmetic/wide_direction.hpp"

// Compares corners with rational constructions from their names.
namespace tubefoot {
namespace {

using namespace test;

template <class Check>
void for_all_corners(std::uint64_t seed, const Check& check) {
  VisibilityScratch scratch;
  TubeVisibility seen;
  for (const Scene& scene : all_scenes(seed)) {
    SCOPED_TRACE(testing::Message() << "seed " << seed << ", " << scene.name);
    const SceneTree tree(scene.mesh);
    for (std::uint32_t t = 0; t < scene.tubes.tubes.size(); ++t) {
      see(scene.mesh, tree, scene.tubes, t, with(Arithmetic::fixed), scratch, seen);
      const NameContext context{scene.mesh, scene.tubes.apex, seen.rays};
      for (const NamedPiece& piece : seen.pieces)
        for (std::uint32_t k = 0; k < piece.count; ++k) {
          const CornerName& corner = seen.corners[piece.first + k];
          check(context, corner, piece.facet, direction_of(scene.mesh, scene.tubes.apex, seen, corner));
        }
    }
  }
}

// Law E1.
TEST(ExactCorner, IsWithinFourUnitsInTheLastPlaceOfItsNames) {
  std::size_t corners = 0, crossings = 0;
  for (std::uint64_t seed = 1; seed <= 2; ++seed)
    for_all_corners(seed,
                    [&](const NameContext& context, const CornerName& corner, FacetId facet, const V3& d) {
                      FacetCone cone;
                      ASSERT_TRUE(FacetCone::make(context.mesh, facet, context.apex, cone));
                      const SeenFrom plane = seen_from(context.mesh, facet, context.apex).value();
                      const Q along = plane.c / scalar_product(plane.n, d);
                      const glm::dvec3 found = point_on_facet(context, corner, cone);
                      for (int k = 0; k < 3; ++k) {
                        const Q exact = along * d[k];
                        const Q unit = CGAL::abs(exact) * Q(std::numeric_limits<double>::epsilon());
                        EXPECT_LE(CGAL::abs(Q(found[k]) - exact), 4 * unit) << "coordinate " << k;
                      }
                      ++corners;
                      crossings += corner.point == no_point && (corner.p.depth || corner.q.depth);
                    });
  EXPECT_GT(corners, 5000u);
  EXPECT_GT(crossings, 500u) << "hardly a corner lies on a depth plane";
}

// Law E2.
TEST(ExactCorner, DirectionIsThatOfItsNames) {
  std::size_t corners = 0;
  for_all_corners(3, [&](const NameContext& context, const CornerName& corner, FacetId, const V3& d) {
    const WideVec wide = wide_direction(context, corner);
    V3 found;
    for (int k = 0; k < 3; ++k) found[k] = Q(wide[k].str());
    EXPECT_EQ(vector_product(found, d), (V3{0, 0, 0}));
    EXPECT_GT(scalar_product(found, d), 0);
    ++corners;
  });
  EXPECT_GT(corners, 2500u);
}

}  // namespace
}  // namespace tubefoot
