// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the audit of paths: the laws of the views of images and of the common visibility of pairs of images
// (docs/notes/multiple-paths.md). It also tests that the audit detects violations.
#include "engine/paths/path_audit.hpp"

#include <gtest/gtest.h>

#include <set>

#include "engine/visibility/tube_engine.hpp"
#include "fixtures/world/path_scenes.hpp"

namespace tubefoot {
namespace {

using namespace test;

FacetMesh harbour() {
  FacetMesh mesh = square_seabed(-4, 9);
  add_quad(mesh, {2, -3, -4}, {2, 3, -4}, {2.5, 3, -1.5}, {2.5, -3, -1.5}, 1);
  add_quad(mesh, {-2, 1, -4}, {-1, 1, -4}, {-1, 1, -2.5}, {-2, 1, -2.5});
  return mesh;
}

/// A seabed, a wall and a tilted plate that is a mirror, under a water surface.
struct Harbour {
  const FacetMesh mesh = harbour();
  const SceneTree tree{mesh};
  const std::vector<double> reflection{0, 0.5};
  PathSettings paths;
  Harbour() {
    paths.order = 3;
    paths.mirrors.reflection = reflection;
    paths.mirrors.surface = SeaSurface{0, 0.9, 0};
  }
  PathImages images(const TubeSet& transmit, const TubeSet& receive) const {
    VisibilityOptions options;
    options.open_water = true;
    return PathImages(mesh, tree, unit, options, transmit, receive, paths, 0);
  }
};

// Law I4, and closure.
TEST(PathAudit, ClosesForEveryImageAndPair) {
  const Harbour harbour;
  const TubeSet one = around({0.1, 0.2, -2}, -80, 75, 3, 40),
                other = around({-0.4, 0.1, -1.5}, -80, 75, 3, 40);
  for (const TubeSet* receive : {&one, &other}) {
    const PathImages images = harbour.images(one, *receive);
    const PathAudit audit = audit_paths(images, 7);
    EXPECT_EQ(images.one_place(), receive == &one);
    EXPECT_GE(audit.images.size(), receive == &one ? 4u : 8u);
    EXPECT_EQ(audit.pairs, images.pairs().size());
    EXPECT_GE(audit.pairs, 6u);
    std::set<std::uint32_t> mirrors;
    std::size_t receivers = 0, windows = 0;
    std::set<std::uint64_t> hashes;
    for (const ImageAudit& image : audit.images) {
      mirrors.insert(image.mirrors);
      receivers += image.of_receiver;
      EXPECT_TRUE(image.fills()) << image.windows_sr << " of " << image.mirror_sr;
      EXPECT_LT(image.rounding_sr, 1e-6 * image.mirror_sr);
      for (const TubeAudit& window : image.windows) {
        EXPECT_TRUE(window.closes) << window.defect;
        if (window.pieces == 0) continue;
        ++windows;
        hashes.insert(window.hash.low);
      }
    }
    EXPECT_EQ(mirrors, (std::set<std::uint32_t>{1, 2}));
    EXPECT_EQ(receivers > 0, receive == &other);
    EXPECT_EQ(hashes.size(), windows) << "each has a label of its own";
    std::size_t shared = 0;
    for (const SharedAudit& facet : audit.shared) {
      EXPECT_TRUE(facet.closes) << facet.defect;
      shared += facet.pieces > 0;
    }
    EXPECT_GT(shared, 10u);
  }
}

TEST(PathAudit, AMissingWindowAndAMissingPieceShow) {
  const Harbour harbour;
  const TubeSet tubes = around({0.1, 0.2, -2}, -80, 75, 3, 40);
  const PathImages images = harbour.images(tubes, tubes);
  std::size_t broken = 0;
  for (const Image& image : images.sent()) {
    if (image.mirrors == 0) continue;
    Image less = image;
    less.windows.tubes.pop_back();
    less.seen.pop_back();
    EXPECT_FALSE(audit_image(less, false, 0).fills());
    for (std::size_t window = 0; window < image.seen.size(); ++window) {
      if (image.seen[window].pieces.empty()) continue;
      Image blind = image;
      blind.seen[window].pieces.pop_back();
      EXPECT_FALSE(audit_image(blind, false, 0).windows[window].closes);
      ++broken;
    }
  }
  EXPECT_GT(broken, 10u);
}

// Labels of pings, groups and transmissions have 64 bits. An earlier version shifted out half of the bits,
// so that transmissions of a ping with exchanged results had the same hash.
TEST(AuditLabels, EveryBitCounts) {
  const Harbour harbour;
  const TubeEngine engine(harbour.mesh, harbour.tree, unit, VisibilityOptions());
  const TubeSet tubes = around({0.1, 0.2, -2}, -80, 75, 1, 40);
  std::set<std::uint64_t> hashes;
  std::size_t count = 0;
  const auto add = [&](std::uint64_t label) {
    for (const TubeAudit& audit : engine.audit(tubes, label)) {
      if (audit.pieces == 0) continue;
      hashes.insert(audit.hash.low);
      ++count;
    }
  };
  add(0);
  for (int bit = 0; bit < 64; ++bit) add(std::uint64_t{1} << bit);
  EXPECT_GT(count, 65u * 4);
  EXPECT_EQ(hashes.size(), count);
}

}  // namespace
}  // namespace tubefoot
