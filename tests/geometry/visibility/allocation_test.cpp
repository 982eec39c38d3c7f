// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <new>

#include "fixtures/geometry/layered_scenes.hpp"
#include "geometry/footprints/footprint_builder.hpp"
#include "validation/bench/allocations.hpp"

// Tests that the steady state allocates no memory: not per predicate, per facet or per footprint. This is a
// separate program because it replaces operator new.
namespace tubefoot {
namespace {

using namespace test;

struct Buffers {
  VisibilityScratch scratch;
  TubeVisibility seen;
  FootprintSet set;
};

void clear(FootprintSet& set) {
  set.footprints.clear();
  set.pieces.clear();
  set.corners_m.clear();
  set.occluders.clear();
  set.open_pieces.clear();
  set.open_directions.clear();
}

/// Computes all tubes of a ping into reused buffers. Returns the number of allocations.
std::uint64_t allocations_of_a_ping(const Scene& scene, const SceneTree& tree,
                                    const VisibilityOptions& options, Buffers& buffers) {
  const std::uint64_t before = allocations();
  clear(buffers.set);
  for (std::uint32_t t = 0; t < scene.tubes.tubes.size(); ++t) {
    see(scene.mesh, tree, scene.tubes, t, options, buffers.scratch, buffers.seen);
    append_footprints(scene.mesh, scene.tubes, t, buffers.seen, 1, buffers.set);
  }
  return allocations() - before;
}

TEST(Allocations, AreCounted) {
  const std::uint64_t before = allocations();
  ::operator delete(::operator new(16));
  ::operator delete(::operator new(64, std::align_val_t(64)), std::align_val_t(64));
  EXPECT_EQ(allocations(), before + 2);
}

TEST(Allocations, FixedAllocatesNothingInTheSteadyState) {
  std::size_t footprints = 0, depth_planes = 0, split = 0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed)
    for (const Scene& scene : all_scenes(seed)) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", " << scene.name);
      const SceneTree tree(scene.mesh);
      Buffers buffers;
      VisibilityOptions options;
      options.facets_per_split = 4;  // tubes that are split have their own buffers
      options.open_water = true;
      EXPECT_GT(allocations_of_a_ping(scene, tree, options, buffers), 0u) << "the first ping";
      // Two lists alternate, so that both are long enough after two pings.
      allocations_of_a_ping(scene, tree, options, buffers);
      for (int ping = 0; ping < 2; ++ping)
        EXPECT_EQ(allocations_of_a_ping(scene, tree, options, buffers), 0u) << "the same ping again";
      footprints += buffers.set.footprints.size();
      for (std::uint32_t t = 0; t < scene.tubes.tubes.size(); ++t) {
        see(scene.mesh, tree, scene.tubes, t, options, buffers.scratch, buffers.seen);
        for (const CornerName& corner : buffers.seen.corners)
          depth_planes += corner.p.depth || corner.q.depth;
        split += buffers.seen.rays.size() > 4;
      }
    }
  EXPECT_GT(footprints, 1000u);
  EXPECT_GT(depth_planes, 1000u) << "facets that cross each other are part of the test";
  EXPECT_GT(split, 100u);
}

}  // namespace
}  // namespace tubefoot
