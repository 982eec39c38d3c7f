// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/visibility/piece_tree.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "fixtures/geometry/grid_scenes.hpp"
#include "fixtures/geometry/looks.hpp"

// Tests `PieceTree`, which is independent of cones: here its pieces are intervals [first, first + count) of
// integers.
namespace tubefoot {
namespace {

using namespace test;

std::uint32_t end_of(PieceRange piece) { return piece.first + piece.count; }

/// Removes an interval. Each end is a separate query, as the planes of a facet are.
struct Away {
  PieceRange away;
  static constexpr unsigned left_end = 1, right_end = 2;
  std::size_t looks = 0;

  bool meets(PieceRange piece, unsigned& requested) {
    ++looks;
    if (requested & left_end) {
      if (end_of(piece) <= away.first) return false;
      if (piece.first >= away.first) requested &= ~left_end;
    }
    if (requested & right_end) {
      if (piece.first >= end_of(away)) return false;
      if (end_of(piece) <= end_of(away)) requested &= ~right_end;
    }
    return true;
  }

  bool cut(PieceRange piece, unsigned requested, std::vector<PieceRange>& rest) {
    ++looks;
    const bool left = requested & left_end, right = requested & right_end;
    if (left && away.first > piece.first)
      rest.push_back({piece.first, std::min(away.first, end_of(piece)) - piece.first});
    // if something is already in `rest`, the call does not count
    if (left && end_of(piece) <= away.first) return false;
    if (right && piece.first >= end_of(away)) return false;
    if (right && end_of(piece) > end_of(away)) rest.push_back({end_of(away), end_of(piece) - end_of(away)});
    return true;
  }

  bool operator()(PieceTree& tree) {
    return tree.take_away(
        left_end | right_end,
        [this](PieceRange piece, unsigned& requested) { return meets(piece, requested); },
        [this](PieceRange piece, unsigned requested, std::vector<PieceRange>& rest) {
          return cut(piece, requested, rest);
        });
  }
};

std::vector<PieceRange> pieces_of(PieceTree& tree) {
  std::vector<PieceRange> pieces;
  tree.each([&](PieceRange piece) { pieces.push_back(piece); });
  return pieces;
}

// Law L3.
TEST(PieceTree, HoldsWhatAListWouldHold) {
  PieceTree tree;  // one tree for all, as in the kernel
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const std::int32_t length = 1 << uniform(random, 0, 14),
                       widest = std::max(1, length >> uniform(random, 0, 9));
    std::vector<PieceRange> list{{0, static_cast<std::uint32_t>(length)}};
    tree.begin(list.front());
    for (int k = uniform(random, 0, 300); k > 0; --k) {
      Away away{{static_cast<std::uint32_t>(uniform(random, 0, length)),
                 static_cast<std::uint32_t>(uniform(random, 1, widest))}};
      std::vector<PieceRange> kept;
      bool taken = false;
      for (const PieceRange& piece : list) {
        std::vector<PieceRange> rest;
        if (Away(away).cut(piece, Away::left_end | Away::right_end, rest)) {
          taken = true;
          kept.insert(kept.end(), rest.begin(), rest.end());
        } else {
          kept.push_back(piece);
        }
      }
      list.swap(kept);
      ASSERT_EQ(away(tree), taken);
      ASSERT_EQ(tree.empty(), list.empty());
      ASSERT_EQ(pieces_of(tree), list);
    }
  }
}

TEST(PieceTree, LooksAtThePiecesAboutACutAndNotAtAll) {
  constexpr std::uint32_t cuts = 4096;
  Random random(5);
  std::vector<std::uint32_t> places(cuts);
  for (std::uint32_t k = 0; k < cuts; ++k) places[k] = 2 * k + 1;
  std::shuffle(places.begin(), places.end(), random);
  PieceTree tree;
  tree.begin({0, 2 * cuts + 1});
  std::size_t looks = 0;
  for (const std::uint32_t place : places) {
    Away away{{place, 1}};
    EXPECT_TRUE(away(tree));
    looks += away.looks;
  }
  EXPECT_EQ(pieces_of(tree).size(), cuts + 1);
  // A random tree is about twice as deep as a balanced one, and both children of a node are visited. A list
  // would have 2048 pieces on average.
  EXPECT_LT(looks, 6 * 12 * cuts);
}

/// Long thin facets across the view in all directions, nearer at one end than at the other. Each passes
/// over, under or through all others.
FacetMesh interlaced_strips(Random& random, int count) {
  FacetMesh mesh;
  for (int k = 0; k < count; ++k) {
    const double angle = std::numbers::pi * uniform(random, 0, 999) / 1000;
    const GridPoint along{static_cast<std::int32_t>(std::lround(600000 * std::cos(angle))), 0,
                          static_cast<std::int32_t>(std::lround(600000 * std::sin(angle)))};
    const std::int32_t x = uniform(random, -100000, 100000), z = uniform(random, -100000, 100000);
    const auto depth = [&random] { return 1000000 + uniform(random, -50000, 50000); };
    const VertexId from = add_vertex(mesh, {x - along.x, depth(), z - along.z}),
                   to = add_vertex(mesh, {x + along.x, depth(), z + along.z}),
                   beside =
                       add_vertex(mesh, {x - along.x - along.z / 100, depth(), z - along.z + along.x / 100});
    add_facet(mesh, from, to, beside);
  }
  return mesh;
}

// Laws V6 and L3: in a narrow tube no receiver has more pieces than a list can store.
TEST(PieceTree, SliversThroughOneAnotherAreSeenAsInNarrowTubes) {
  constexpr int across = 12;
  const TubeSet narrow = lattice_tubes({0, 0, 0}, -across / 2, -across / 2, across, across, 50, 20000);
  TubeSet wide = narrow;
  wide.tubes = {{0, across * (across + 1), (across + 1) * (across + 1) - 1, across}};
  const ExactVector axis{0, 1, 0};
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const FacetMesh mesh = interlaced_strips(random, 40);
    const SceneTree tree(mesh);
    VisibilityScratch scratch;
    Areas whole, parts;
    add_areas(whole, mesh, tree, wide, 0, axis, scratch);
    for (std::uint32_t tube = 0; tube < narrow.tubes.size(); ++tube)
      add_areas(parts, mesh, tree, narrow, tube, axis, scratch);
    EXPECT_TRUE(whole == parts);
    EXPECT_EQ(look(mesh, wide).not_closed, 0u);

    TubeVisibility seen;
    see(mesh, tree, wide, 0, with(Arithmetic::fixed), scratch, seen);
    std::map<FacetId, int> pieces;
    for (const NamedPiece& piece : seen.pieces) ++pieces[piece.facet];
    EXPECT_TRUE(std::any_of(pieces.begin(), pieces.end(), [](const auto& p) { return p.second > 20; }));
  }
}

}  // namespace
}  // namespace tubefoot
