// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/visibility/contradictions.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "fixtures/geometry/grid_scenes.hpp"
#include "fixtures/geometry/looks.hpp"
#include "geometry/arithmetic/exact_corner.hpp"

namespace tubefoot {
namespace {

// In the adversarial cases, doubles make contradictory corners. The kernel omits these corners, and each
// remaining one can be projected onto its facet. Exact arithmetic makes none.
TEST(Contradictions, OfDoublesAreLeftOutAndExactLooksHaveNone) {
  std::size_t left_out = 0, kept = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed)
    for (const test::Scene& scene : test::adversarial_cases(seed)) {
      SCOPED_TRACE(testing::Message() << scene.name << ", seed " << seed);
      const SceneTree tree(scene.mesh);
      VisibilityScratch scratch;
      for (std::uint32_t tube = 0; tube < scene.tubes.tubes.size(); ++tube)
        for (const Arithmetic arithmetic : {Arithmetic::fixed, Arithmetic::plain_double}) {
          TubeVisibility seen;
          see(scene.mesh, tree, scene.tubes, tube, test::with(arithmetic), scratch, seen);
          const TubeVisibility before = seen;
          leave_out_contradictions(scene.mesh, scene.tubes.apex, seen);
          std::size_t all = 0, now = 0;
          for (const NamedPiece& piece : before.pieces) all += piece.count;
          const NameContext context{scene.mesh, scene.tubes.apex, seen.rays};
          for (const NamedPiece& piece : seen.pieces) {
            now += piece.count;
            ASSERT_GE(piece.count, 3u);
            FacetCone cone;
            ASSERT_TRUE(FacetCone::make(scene.mesh, piece.facet, scene.tubes.apex, cone));
            for (std::uint32_t k = 0; k < piece.count; ++k) {
              const glm::dvec3 p = point_on_facet(context, seen.corners[piece.first + k], cone);
              ASSERT_TRUE(std::isfinite(p.x + p.y + p.z));
            }
          }
          if (arithmetic == Arithmetic::fixed) {
            ASSERT_EQ(seen.pieces.size(), before.pieces.size());
            ASSERT_EQ(seen.open.size(), before.open.size());
            ASSERT_EQ(now, all);
          } else {
            left_out += all - now;
            kept += now;
          }
        }
    }
  EXPECT_GT(left_out, 0u);
  EXPECT_GT(kept, 10 * left_out);
}

}  // namespace
}  // namespace tubefoot
