// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that footprints keep the names of their corners and the unobstructed region of each tube, on request.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

#include "fixtures/geometry/layered_scenes.hpp"
#include "fixtures/geometry/looks.hpp"
#include "geometry/arithmetic/exact_corner.hpp"
#include "geometry/footprints/footprint_builder.hpp"
#include "geometry/integrals/measure.hpp"
#include "geometry/mesh/facet_cone.hpp"

namespace tubefoot {
namespace {

constexpr std::uint64_t seed = 20281;

/// One set per tube, joined, so that the names of all tubes refer to the rays of one set.
FootprintSet footprints_of(const test::Scene& scene, const VisibilityOptions& options) {
  const SceneTree tree(scene.mesh);
  VisibilityScratch scratch;
  TubeVisibility seen;
  std::vector<FootprintSet> sets(scene.tubes.tubes.size());
  for (std::uint32_t tube = 0; tube < sets.size(); ++tube) {
    see(scene.mesh, tree, scene.tubes, tube, options, scratch, seen);
    append_footprints(scene.mesh, scene.tubes, tube, seen, 1, sets[tube], options.corner_names);
  }
  FootprintSet all = joined(sets);
  measure(all);
  return all;
}

glm::dvec3 direction_of_ray(GridPoint ray) { return {ray.x, ray.y, ray.z}; }

/// Solid angle of a convex cone of unit vectors, as a fan of triangles (A. van Oosterom and J. Strackee, IEEE
/// Trans. Biomed. Eng. 30, 1983).
double solid_angle_of(const glm::dvec3* d, std::uint32_t count) {
  double sum = 0;
  for (std::uint32_t k = 1; k + 1 < count; ++k)
    sum += 2 * std::atan2(std::abs(glm::dot(d[0], glm::cross(d[k], d[k + 1]))),
                          1 + glm::dot(d[0], d[k]) + glm::dot(d[k], d[k + 1]) + glm::dot(d[k + 1], d[0]));
  return sum;
}

TEST(CornerNames, GiveTheCornersOfAllFootprints) {
  VisibilityOptions options = test::with(Arithmetic::fixed);
  options.corner_names = true;
  std::size_t compared = 0, on_rays = 0;
  for (const test::Scene& scene : test::adversarial_cases(seed)) {
    SCOPED_TRACE(testing::Message() << scene.name << ", seed " << seed);
    const FootprintSet set = footprints_of(scene, options);
    ASSERT_EQ(set.corner_names.size(), set.corners_m.size());
    const NameContext context{scene.mesh, scene.tubes.apex, set.name_rays};
    for (const Footprint& footprint : set.footprints) {
      FacetCone cone;
      FacetCone::make(scene.mesh, footprint.facet, scene.tubes.apex, cone);
      for (std::uint32_t k = 0; k < footprint.piece_count; ++k) {
        const Piece& piece = set.pieces[footprint.first_piece + k];
        for (std::uint32_t c = piece.first; c < piece.first + piece.count; ++c) {
          EXPECT_EQ(point_on_facet(context, set.corner_names[c], cone), set.corners_m[c]);
          ++compared;
          if (set.corner_names[c].point != no_point && (set.corner_names[c].point & ray_bit)) ++on_rays;
        }
      }
    }
  }
  EXPECT_GT(compared, 1000u);
  EXPECT_GT(on_rays, 0u);
}

TEST(CornerNames, AreNotKeptUnlessRequested) {
  for (const test::Scene& scene : test::adversarial_cases(seed)) {
    const FootprintSet set = footprints_of(scene, VisibilityOptions{});
    EXPECT_TRUE(set.corner_names.empty() && set.name_rays.empty()) << scene.name;
    EXPECT_TRUE(set.open_pieces.empty() && set.open_directions.empty()) << scene.name;
  }
}

// Law C1 in floating point: the unobstructed region is what footprints leave of a tube.
TEST(UnobstructedRegion, IsTheRestOfEachTube) {
  VisibilityOptions options = test::with(Arithmetic::fixed);
  options.open_water = true;
  std::size_t partly_covered = 0;
  for (const test::Scene& scene : test::adversarial_cases(seed)) {
    SCOPED_TRACE(testing::Message() << scene.name << ", seed " << seed);
    const FootprintSet set = footprints_of(scene, options);
    std::vector<double> covered(scene.tubes.tubes.size()), open(covered.size());
    for (const Footprint& footprint : set.footprints) covered[footprint.tube] += footprint.solid_angle_sr;
    for (const OpenPiece& piece : set.open_pieces)
      open[piece.tube] += solid_angle_of(&set.open_directions[piece.first], piece.count);
    for (std::uint32_t tube = 0; tube < covered.size(); ++tube) {
      std::vector<glm::dvec3> rays;
      for (const std::uint32_t number : scene.tubes.tubes[tube])
        rays.push_back(glm::normalize(direction_of_ray(scene.tubes.rays[number])));
      const double whole = solid_angle_of(rays.data(), static_cast<std::uint32_t>(rays.size()));
      EXPECT_NEAR(covered[tube] + open[tube], whole, 1e-14 * whole) << "tube " << tube;
      if (covered[tube] > 0 && open[tube] > 0) ++partly_covered;
    }
  }
  EXPECT_GT(partly_covered, 10u);
}

}  // namespace
}  // namespace tubefoot
