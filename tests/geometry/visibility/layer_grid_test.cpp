// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/visibility/layer_grid.hpp"

#include <gtest/gtest.h>

#include <map>
#include <numeric>
#include <set>
#include <string>

#include "fixtures/geometry/exact_oracles.hpp"
#include "fixtures/geometry/layered_scenes.hpp"

// Compares the decisions of the layer grid on facets and pairs with brute force. The brute force clips each
// facet by each other in rationals, without a grid or properties of surfaces.
namespace tubefoot {
namespace {

using namespace test;

/// The facets of one tube in the form that the grid receives, with neighbours by their definition.
struct InTube {
  GnomonicFrame frame;
  std::vector<FramedFacet> facets;
  std::vector<Neighbours> neighbours;
  LayerGrid grid;
};

bool on_inner_side(const Vec64& wall, GridPoint p) { return dot(wall, p) > 0; }

InTube in_tube(const FacetMesh& mesh, const TubeSet& tubes, std::uint32_t tube) {
  std::array<GridPoint, 4> ray;
  std::array<Vec64, 4> wall;
  for (int k = 0; k < 4; ++k) ray[k] = tubes.rays[tubes.tubes[tube][k]];
  for (int k = 0; k < 4; ++k) wall[k] = cross(ray[k], ray[(k + 1) % 4]);
  InTube result;
  result.frame = GnomonicFrame(ray);
  for (FacetId f = 0; f < mesh.facets.size(); ++f) {
    FramedFacet facet;
    if (!FacetCone::make(mesh, f, tubes.apex, facet.cone)) continue;
    const auto& p = facet.cone.point;
    if (std::any_of(wall.begin(), wall.end(), [&](const Vec64& w) {
          return !on_inner_side(w, p[0]) && !on_inner_side(w, p[1]) && !on_inner_side(w, p[2]);
        }))
      continue;
    facet.measure_ranges();
    facet.place(result.frame);
    result.facets.push_back(facet);
  }

  struct Side {
    std::int32_t facet;
    int edge;
  };
  std::map<std::pair<VertexId, VertexId>, std::vector<Side>> sides;
  for (std::size_t f = 0; f < result.facets.size(); ++f)
    for (int k = 0; k < 3; ++k) {
      const auto& v = result.facets[f].cone.vertex;
      sides[std::minmax(v[k], v[(k + 1) % 3])].push_back({static_cast<std::int32_t>(f), k});
    }
  result.neighbours.assign(result.facets.size(), {silhouette, silhouette, silhouette});
  for (const auto& [edge, at] : sides) {
    const auto& [f, k] = at[0];
    const FacetCone& cone = result.facets[f].cone;
    const GridPoint a = cone.point[k], b = cone.point[(k + 1) % 3];
    if (at.size() == 2) {
      const auto& [g, j] = at[1];
      // f lies on the positive side of the plane through its edge. The edge is not a fold if g lies on the
      // other side.
      if (dot(cross(a, b), result.facets[g].cone.point[(j + 2) % 3]) >= 0) continue;
      result.neighbours[f][k] = g;
      result.neighbours[g][j] = f;
    } else if (at.size() == 1 && std::any_of(wall.begin(), wall.end(), [&](const Vec64& w) {
                 return !on_inner_side(w, a) && !on_inner_side(w, b);
               })) {
      result.neighbours[f][k] = outside_tube;
    }
  }
  result.grid.build(result.frame, result.facets, result.neighbours);
  return result;
}

/// Returns whether a convex cone has an interior: three of its corners are not in one plane.
bool has_interior(const Cone& cone) {
  for (std::size_t k = 2; k < cone.size(); ++k)
    if (scalar_product(cone[0], vector_product(cone[k - 1], cone[k])) != 0) return true;
  return false;
}

/// Returns directions without their common factors, so that numbers stay short over many clips.
Cone shortened(Cone cone) {
  for (V3& d : cone) {
    const Q largest = CGAL::max(CGAL::abs(d[0]), CGAL::max(CGAL::abs(d[1]), CGAL::abs(d[2])));
    for (Q& x : d) x /= largest;
  }
  return cone;
}

/// All facets of a tube, clipped by each other.
class BruteForce {
 public:
  BruteForce(const FacetMesh& mesh, const TubeSet& tubes, std::uint32_t tube, const InTube& seen)
      : mesh_(mesh), walls_(walls_of(cone_of(tubes, tube))), facets_(seen.facets) {
    for (const FramedFacet& facet : facets_)
      from_.push_back(seen_from(mesh, facet.cone.id, tubes.apex).value());
    for (std::size_t f = 0; f < facets_.size(); ++f) {
      std::vector<std::uint32_t> others(facets_.size());
      std::iota(others.begin(), others.end(), 0u);
      visible_.push_back(left_of(f, others));
    }
  }

  const std::vector<Cone>& visible(std::size_t f) const { return visible_[f]; }

  /// Returns the remaining part of a facet after removal of the parts that the listed facets hide.
  std::vector<Cone> left_of(std::size_t f, const std::vector<std::uint32_t>& others) const {
    std::vector<Cone> pieces{clipped({from_[f].vertex.begin(), from_[f].vertex.end()}, walls_)};
    std::erase_if(pieces, [](const Cone& c) { return !has_interior(c); });
    for (const std::uint32_t o : others) {
      if (pieces.empty()) break;
      if (o == f || !facets_[o].bounds.meets(facets_[f].bounds)) continue;
      const std::vector<V3> halves = hiding(f, o);
      if (halves.empty()) continue;
      std::vector<Cone> left;
      for (const Cone& piece : pieces) {
        if (!has_interior(clipped(piece, halves))) {
          left.push_back(piece);
          continue;
        }
        Cone rest = piece;
        for (const V3& half : halves) {
          Cone outside = clipped(rest, times(-1, half));
          if (has_interior(outside)) left.push_back(shortened(std::move(outside)));
          rest = clipped(rest, half);
        }
      }
      pieces = std::move(left);
    }
    return pieces;
  }

  /// Returns whether the visible part of `occluder` lies before a part of `facet` within the tube.
  bool is_before(std::size_t occluder, std::size_t facet) const {
    if (!facets_[occluder].bounds.meets(facets_[facet].bounds)) return false;
    std::vector<V3> halves = hiding(facet, occluder);
    if (halves.empty()) return false;
    halves.insert(halves.end(), from_[facet].inward.begin(), from_[facet].inward.end());
    return std::any_of(visible_[occluder].begin(), visible_[occluder].end(),
                       [&](const Cone& piece) { return has_interior(clipped(piece, halves)); });
  }

 private:
  /// The half-spaces in which o hides f; empty if o never hides f.
  std::vector<V3> hiding(std::size_t f, std::size_t o) const {
    std::vector<V3> halves(from_[o].inward.begin(), from_[o].inward.end());
    if (!same_plane(from_[f], from_[o]))
      halves.push_back(nearer_side(from_[f], from_[o]));
    else if (!wins_tie(mesh_, facets_[o].cone.id, facets_[f].cone.id))
      halves.clear();
    return halves;
  }

  const FacetMesh& mesh_;
  std::vector<V3> walls_;
  const std::vector<FramedFacet>& facets_;
  std::vector<SeenFrom> from_;
  std::vector<std::vector<Cone>> visible_;
};

struct Tally {
  std::size_t facets = 0, hidden = 0, truly_hidden = 0, pairs = 0, candidates = 0, true_occluders = 0;
};

/// Checks each facet and pair of each tube of a scene.
void check(const Scene& scene, Tally& tally) {
  for (std::uint32_t t = 0; t < scene.tubes.tubes.size(); ++t) {
    SCOPED_TRACE(testing::Message() << "tube " << t);
    InTube seen = in_tube(scene.mesh, scene.tubes, t);
    const BruteForce truth(scene.mesh, scene.tubes, t, seen);
    std::vector<std::uint32_t> candidates;
    for (std::uint32_t f = 0; f < seen.facets.size(); ++f) {
      ++tally.facets;
      tally.truly_hidden += truth.visible(f).empty();
      if (seen.grid.is_hidden(f)) {
        ++tally.hidden;
        EXPECT_TRUE(truth.visible(f).empty()) << "facet " << seen.facets[f].cone.id << " is seen";
        continue;
      }
      seen.grid.occluder_candidates(f, candidates);
      const std::set<std::uint32_t> given(candidates.begin(), candidates.end());
      EXPECT_EQ(given.size(), candidates.size()) << "a candidate twice";
      EXPECT_FALSE(given.contains(f)) << "a facet that hides itself";
      double distance = 0;
      for (const std::uint32_t c : candidates) {
        EXPECT_FALSE(seen.grid.is_hidden(c));
        EXPECT_GE(seen.facets[c].nearest, distance) << "not nearest first";
        distance = seen.facets[c].nearest;
      }
      tally.candidates += candidates.size();
      for (std::uint32_t o = 0; o < seen.facets.size(); ++o) {
        if (o == f) continue;
        tally.pairs += seen.facets[o].bounds.meets(seen.facets[f].bounds);
        if (!truth.is_before(o, f)) continue;
        ++tally.true_occluders;
        EXPECT_TRUE(given.contains(o)) << "facet " << seen.facets[o].cone.id << " hides part of facet "
                                       << seen.facets[f].cone.id << " and is no candidate";
      }
      if (truth.visible(f).empty()) {
        EXPECT_TRUE(truth.left_of(f, candidates).empty())
            << "candidates leave something of facet " << seen.facets[f].cone.id;
      }
    }
    if (testing::Test::HasFailure()) return;
  }
}

// Laws L1 and L2.
TEST(LayerGrid, HidesOnlyTheHiddenAndMissesNoOccluder) {
  Tally tally;
  const std::uint64_t seed = 1;
  for (const Scene& scene : one_in > 1 ? adversarial_cases(seed) : all_scenes(seed)) {
    SCOPED_TRACE(testing::Message() << "seed " << seed << ", " << scene.name);
    check(scene, tally);
    if (testing::Test::HasFailure()) return;
  }
  EXPECT_GT(tally.hidden, one_in > 1 ? 0 : 250) << "of " << tally.truly_hidden;
  EXPECT_GT(tally.true_occluders, 1500 / one_in);
}

// A closed surface hides everything behind it. Hardly any hidden facet is compared with another.
TEST(LayerGrid, AClosedSheetHidesWhatIsBehindItAndNeedsFewPairs) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    Scene scene{"sheet before a soup", {}, lattice_tubes({0, 0, 0}, -1, -1, 1, 1, 4, 2)};
    const auto number = [&](int size) { return uniform(random, -size, size); };
    add_sheet(scene.mesh, 8, 8, [&](int u, int v) {
      return GridPoint{(u - 4) * 1000 + number(200), 8000 + number(300), (v - 4) * 1000 + number(200)};
    });
    const std::size_t sheet = scene.mesh.facets.size();
    const FacetMesh random_triangles = make_random_triangles(random, 60, 40000, 9000);
    const auto shift = static_cast<VertexId>(scene.mesh.vertices.size());
    for (const GridPoint& p : random_triangles.vertices) scene.mesh.vertices.push_back(p);
    for (const auto& v : random_triangles.facets)
      add_facet(scene.mesh, v[0] + shift, v[1] + shift, v[2] + shift);

    InTube seen = in_tube(scene.mesh, scene.tubes, 0);
    std::size_t behind = 0, pairs = 0, met = 0;
    std::vector<std::uint32_t> candidates;
    for (std::uint32_t f = 0; f < seen.facets.size(); ++f) {
      const bool in_sheet = seen.facets[f].cone.id < sheet;
      behind += !in_sheet;
      EXPECT_EQ(seen.grid.is_hidden(f), !in_sheet) << "facet " << seen.facets[f].cone.id;
      if (seen.grid.is_hidden(f)) continue;
      seen.grid.occluder_candidates(f, candidates);
      pairs += candidates.size();
      met += static_cast<std::size_t>(
          std::count_if(seen.facets.begin(), seen.facets.end(), [&](const FramedFacet& other) {
            return other.cone.id < sheet && other.bounds.meets(seen.facets[f].bounds);
          }));
    }
    EXPECT_GT(behind, 20u);
    EXPECT_LT(pairs, met / 4) << "of pairs whose bounds meet";
  }
}

/// A ramp that winds about a point just outside of the corner of the tube, with three wide steps per turn.
/// No edge of the ramp is a silhouette inside the tube. All steps are connected around the point, and no
/// wall of the tube separates them. Thus one layer covers the tube once per turn.
Scene winding_ramp(Random& random, int turns) {
  Scene scene{"winding ramp", {}, {}};
  scene.tubes.reach = 1e12;
  for (const auto& [x, z] : {std::pair{0, 0}, {0, 1000}, {1000, 1000}, {1000, 0}})
    scene.tubes.rays.push_back({x, 10000, z});
  scene.tubes.tubes = {{0, 1, 2, 3}};
  FacetMesh& mesh = scene.mesh;
  // By gnomonic coordinates x / y, z / y and depth y. The tube is the square from (0, 0) to (0.1, 0.1).
  std::int32_t depth = 100000;
  const auto vertex = [&](double x, double z) {
    const std::int32_t y = depth + uniform(random, -2000, 2000);
    return add_vertex(mesh, {static_cast<std::int32_t>(x * y), y, static_cast<std::int32_t>(z * y)});
  };
  const VertexId hub = vertex(-0.005, -0.005);
  VertexId last = vertex(-0.97, 0.26);
  for (int turn = 0; turn < turns; ++turn) {
    depth += 20000;
    const VertexId right_below = vertex(0.26, -0.97);
    add_facet(mesh, hub, last, right_below);
    add_facet(mesh, last, right_below, vertex(-2, -2));
    depth += 20000;
    const VertexId right_above = vertex(0.7, 0.7);
    add_facet(mesh, hub, right_below, right_above);
    depth += 20000;
    last = vertex(-0.97, 0.26);
    add_facet(mesh, hub, right_above, last);
  }
  return scene;
}

TEST(LayerGrid, ALayerThatCoversACellTwiceIsComparedWithItself) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const int turns = uniform(random, 2, 5);
    const Scene scene = winding_ramp(random, turns);
    const InTube seen = in_tube(scene.mesh, scene.tubes, 0);
    ASSERT_EQ(seen.facets.size(), scene.mesh.facets.size()) << "a step is cut off: the ramp is not connected";
    for (const FramedFacet& facet : seen.facets) ASSERT_TRUE(facet.bounds.is_finite());
    for (const Neighbours& n : seen.neighbours)
      ASSERT_EQ(std::count(n.begin(), n.end(), silhouette), 0) << "the ramp ends in the tube";
    Tally tally;
    check(scene, tally);
    EXPECT_EQ(tally.truly_hidden, tally.facets - 2) << "two steps of the first turn fill the tube";
    EXPECT_GT(tally.true_occluders, 0u);
  }
}

}  // namespace
}  // namespace tubefoot
