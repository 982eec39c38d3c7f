// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <map>
#include <string>

#include "fixtures/geometry/exact_oracles.hpp"
#include "fixtures/geometry/small_views.hpp"
#include "geometry/visibility/closure.hpp"

// Compares the arithmetic that constructs everything in rationals with the two that decide by names,
// doubles and intervals first. The topology hashes are equal. The area of each facet equals a rational area
// in a common plane, which independent code computes from the names of the pieces.
namespace tubefoot {
namespace {

using namespace test;

struct Answer {
  TopologyHash hash;
  bool closes = false;
  std::map<FacetId, Q> area;
};

Answer answer(const Scene& scene, const SceneTree& tree, std::uint32_t tube, Arithmetic arithmetic) {
  VisibilityOptions options;
  options.arithmetic = arithmetic;
  options.open_water = true;
  VisibilityScratch scratch;
  TubeVisibility seen;
  see(scene.mesh, tree, scene.tubes, tube, options, scratch, seen);
  const TubeAudit checked = audit(scene.mesh, scene.tubes, tube, seen, tube);
  Answer found{checked.hash, checked.closes, {}};
  const GnomonicPlane plane(axis_of(cone_of(scene.tubes, tube)));
  for (const NamedPiece& piece : seen.pieces)
    found.area[piece.facet] += plane.area(cone_of(scene.mesh, scene.tubes.apex, seen, piece));
  return found;
}

// Law V2.
TEST(ArithmeticOracle, FixedAndFilteredSeeWhatRationalSees) {
  std::map<std::string, std::size_t> compared;
  for (std::uint64_t seed = 1; seed < 1 + (4 + one_in - 1) / one_in; ++seed) {
    std::vector<Scene> scenes = small_views(seed, 200);
    for (Scene& scene : seed % 3 ? adversarial_cases(seed) : all_scenes(seed))
      scenes.push_back(std::move(scene));
    for (const Scene& scene : scenes) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", " << scene.name);
      const SceneTree tree(scene.mesh);
      for (std::uint32_t t = 0; t < scene.tubes.tubes.size(); ++t) {
        SCOPED_TRACE(testing::Message() << "tube " << t);
        const Answer rational = answer(scene, tree, t, Arithmetic::rational);
        EXPECT_TRUE(rational.closes);
        for (const Arithmetic arithmetic : {Arithmetic::fixed, Arithmetic::filtered}) {
          const Answer other = answer(scene, tree, t, arithmetic);
          EXPECT_EQ(other.hash.hex(), rational.hash.hex()) << name_of(arithmetic);
          EXPECT_EQ(other.area, rational.area) << name_of(arithmetic);
        }
        compared[scene.name] += rational.area.size();
        if (testing::Test::HasFailure()) return;
      }
    }
  }
  for (const auto& [name, facets] : compared) EXPECT_GT(facets, 8 / one_in) << name;
}

}  // namespace
}  // namespace tubefoot
