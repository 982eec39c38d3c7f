// SPDX-License-Identifier: GPL-3.0-or-later
// Checks the laws of docs/notes/visibility.md on one scene: closure, agreement of arithmetics, the predicate,
// facet order, translation, and splitting of tubes and facets.

#include "prove/laws.hpp"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <numeric>
#include <vector>

#include "geometry/visibility/exact_direction.hpp"
#include "geometry/visibility/visibility.hpp"
#include "prove/plane_signs.hpp"
#include "prove/small_scenes.hpp"

namespace tubefoot::prove {
namespace {

using Rational = CGAL::Exact_rational;

/// Cheap laws come more often. `rational` is about twenty times slower than the rest.
constexpr std::array turns{Law::filtered,        Law::predicate,  Law::facet_order, Law::tube_splitting,
                           Law::facet_splitting, Law::filtered,   Law::translation, Law::rational,
                           Law::inner_splitting, Law::predicate,  Law::facet_order, Law::tube_splitting,
                           Law::facet_splitting, Law::translation};

FacetMesh shuffled(Random& random, const FacetMesh& mesh) {
  FacetMesh result = mesh;
  random.shuffle(result.facets);
  for (auto& facet : result.facets) random.shuffle(facet);
  if (random.one_in(3)) {  // no shared vertex
    result.vertices.clear();
    for (auto& facet : result.facets)
      for (VertexId& v : facet) v = add_vertex(result, mesh.vertices[v]);
    return result;
  }
  std::vector<VertexId> place(mesh.vertices.size());
  std::iota(place.begin(), place.end(), 0u);
  random.shuffle(place);
  for (VertexId v = 0; v < place.size(); ++v) result.vertices[place[v]] = mesh.vertices[v];
  for (auto& facet : result.facets)
    for (VertexId& v : facet) v = place[v];
  return result;
}

/// Edges are bisected up to this many times. Their ends then differ by multiples of 8.
constexpr int most_cuts = 3;

/// Returns the scene scaled by 8 about its apex (which changes no visible polygon) or, if that does not
/// fit, rounded to multiples of 8.
FacetMesh with_midpoints(FacetMesh mesh, GridPoint apex) {
  constexpr std::int32_t scale = 1 << most_cuts, end = (1 << WorldGrid::coordinate_bits) / scale;
  bool fits = true;
  for (const GridPoint& p : mesh.vertices) {
    const GridPoint d = p - apex;
    fits = fits && std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)}) <= end;
  }
  for (GridPoint& p : mesh.vertices) {
    const GridPoint d = p - apex;
    const auto whole = [&](std::int32_t x) { return fits ? scale * x : x / scale * scale; };
    p = {apex.x + whole(d.x), apex.y + whole(d.y), apex.z + whole(d.z)};
  }
  return mesh;
}

/// Cuts facets at the midpoint of one edge: all that share the edge, or only one, which makes a T-junction.
void split_an_edge(Random& random, FacetMesh& mesh) {
  const std::size_t chosen = random.index(mesh.facets.size()), k = random.index(3);
  const bool conforming = !random.one_in(3);
  const VertexId a = mesh.facets[chosen][k], b = mesh.facets[chosen][(k + 1) % 3];
  const auto middle = [](std::int32_t p, std::int32_t q) {
    return static_cast<std::int32_t>((std::int64_t(p) + q) / 2);
  };
  const GridPoint pa = mesh.vertices[a], pb = mesh.vertices[b];
  const VertexId m = add_vertex(mesh, {middle(pa.x, pb.x), middle(pa.y, pb.y), middle(pa.z, pb.z)});
  const std::size_t count = mesh.facets.size();
  for (std::size_t f = 0; f < count; ++f) {
    if (!conforming && f != chosen) continue;
    for (std::size_t e = 0; e < 3; ++e) {
      const auto v = mesh.facets[f];
      const VertexId p = v[e], q = v[(e + 1) % 3], r = v[(e + 2) % 3];
      if (!((p == a && q == b) || (p == b && q == a))) continue;
      mesh.facets[f] = {p, m, r};
      add_facet(mesh, m, q, r);
      break;
    }
  }
}

/// The plane n . x = c of a facet about the apex, in lowest terms: equal for coplanar facets. Their
/// vertices decide which of them is visible where they overlap, so that a cut preserves only their sum.
using PlaneKey = std::array<Int128, 4>;

PlaneKey plane_of(const FacetMesh& mesh, FacetId facet, GridPoint apex) {
  FacetCone cone;
  FacetCone::make(mesh, facet, apex, cone);
  PlaneKey key{cone.normal.x, cone.normal.y, cone.normal.z, cone.offset};
  Int128 divisor = 0;
  for (Int128 x : key) {
    x = x < 0 ? -x : x;
    while (x != 0) divisor = std::exchange(x, divisor % x);
  }
  for (Int128& x : key) x /= divisor;
  return key;
}

/// Areas in the plane axis . x = 1, by a key of the facet. Open water is separate.
template <class Key>
struct Areas {
  std::map<Key, Rational> of;
  Rational open = 0;
  bool cones = true;  ///< false if a piece is no cone within the tube, which only inexact signs can cause
  friend bool operator==(const Areas&, const Areas&) = default;
};

}  // namespace

struct Prover::State {
  VisibilityScratch scratch;
  TubeVisibility seen;
  PlaneSigns signs;

  /// Computes a tube. The result is in `seen`.
  void look(const FacetMesh& mesh, const SceneTree& tree, const TubeSet& tubes, std::uint32_t tube,
            Arithmetic arithmetic = Arithmetic::fixed, std::uint32_t facets_per_split = 64) {
    VisibilityOptions options;
    options.arithmetic = arithmetic;
    options.facets_per_split = facets_per_split;
    options.open_water = true;
    see(mesh, tree, tubes, tube, options, scratch, seen);
  }

  template <class Key, class KeyOf>
  void add_areas(Areas<Key>& areas, const FacetMesh& mesh, const SceneTree& tree, const TubeSet& tubes,
                 std::uint32_t tube, const ExactVector& axis, const KeyOf& key_of) {
    look(mesh, tree, tubes, tube);
    const NameContext context{mesh, tubes.apex, seen.rays};
    const auto area = [&](const NamedPiece& piece) {
      const std::vector<ExactVector> directions = exact_directions(context, seen.corners, piece);
      if (in_front(axis, directions)) return gnomonic_area(axis, directions);
      areas.cones = false;
      return Rational(0);
    };
    for (const NamedPiece& piece : seen.pieces) areas.of[key_of(piece.facet)] += area(piece);
    for (const NamedPiece& piece : seen.open) areas.open += area(piece);
  }
};

namespace {

/// A scene with the values that its laws are compared with.
struct Case {
  const SmallScene& scene;
  const SceneTree& tree;
  std::uint64_t number;
  std::array<TopologyHash, tubes_per_scene> hashes{};
  std::uint64_t label(std::uint32_t tube) const { return number * tubes_per_scene + tube; }
};

/// Expects that each tube of `mesh`, `tubes` closes and has the hash of the case.
void compare_hashes(Prover::State& state, const Case& of, const FacetMesh& mesh, const TubeSet& tubes,
                    Law law, Ledger& ledger, Arithmetic arithmetic = Arithmetic::fixed,
                    std::uint32_t facets_per_split = 64) {
  const SceneTree tree(mesh);
  for (std::uint32_t t = 0; t < tubes_per_scene; ++t) {
    state.look(mesh, tree, tubes, t, arithmetic, facets_per_split);
    const TubeAudit found = audit(mesh, tubes, t, state.seen, of.label(t));
    ledger.count(law, of.number, found.closes && found.hash == of.hashes[t]);
  }
}

/// Returns s a + t b, divided by two as often as possible; a direction within the wall of a and b.
GridPoint between(GridPoint a, GridPoint b, std::int64_t s, std::int64_t t) {
  std::array<std::int64_t, 3> d{s * a.x + t * b.x, s * a.y + t * b.y, s * a.z + t * b.z};
  while ((d[0] | d[1] | d[2]) % 2 == 0)
    for (std::int64_t& x : d) x /= 2;
  constexpr std::int64_t end = std::int64_t{1} << WorldGrid::coordinate_bits;
  for (const std::int64_t x : d)
    if (std::abs(x) > end) return GridPoint{};  // does not fit
  return {static_cast<std::int32_t>(d[0]), static_cast<std::int32_t>(d[1]), static_cast<std::int32_t>(d[2])};
}

void check_tube_splitting(Prover::State& state, const Case& of, Random& random, Ledger& ledger) {
  const SmallScene& scene = of.scene;
  for (std::uint32_t t = 0; t < tubes_per_scene; ++t) {
    const ExactVector axis = gnomonic_axis(scene.tubes, t);
    const auto by_facet = [](FacetId f) { return f; };
    Areas<FacetId> whole, parts;
    state.add_areas(whole, scene.mesh, of.tree, scene.tubes, t, axis, by_facet);

    const Tube& tube = scene.tubes.tubes[t];
    const std::uint32_t first = static_cast<std::uint32_t>(random.index(2));
    std::array<GridPoint, 4> r{};
    for (std::uint32_t k = 0; k < 4; ++k) r[k] = scene.tubes.rays[tube[(first + k) % 4]];
    const auto in_wall = [&](GridPoint a, GridPoint b) {
      const std::int32_t by_a = random.between(1, 3), by_b = random.between(1, 3);
      const GridPoint uneven = between(a, b, by_a, by_b);
      return uneven == GridPoint{} ? between(a, b, 1, 1) : uneven;
    };
    const GridPoint low = in_wall(r[0], r[1]), high = in_wall(r[2], r[3]);
    if (low == GridPoint{} || high == GridPoint{}) continue;  // odd rays at the end of the range
    TubeSet halves = scene.tubes;
    halves.rays = {r[0], r[1], r[2], r[3], low, high};
    halves.tubes = {{0, 4, 5, 3}, {4, 1, 2, 5}};
    for (std::uint32_t half = 0; half < 2; ++half)
      state.add_areas(parts, scene.mesh, of.tree, halves, half, axis, by_facet);
    ledger.count(Law::tube_splitting, of.number, whole.cones && parts == whole);
  }
}

void check_facet_splitting(Prover::State& state, const Case& of, Random& random, Ledger& ledger) {
  const TubeSet& tubes = of.scene.tubes;
  const FacetMesh before = with_midpoints(of.scene.mesh, tubes.apex);
  FacetMesh after = before;
  for (int cuts = random.between(1, most_cuts); cuts > 0; --cuts) split_an_edge(random, after);
  const SceneTree tree_before(before), tree_after(after);
  for (std::uint32_t t = 0; t < tubes_per_scene; ++t) {
    const ExactVector axis = gnomonic_axis(tubes, t);
    Areas<PlaneKey> whole, parts;
    state.add_areas(whole, before, tree_before, tubes, t, axis,
                    [&](FacetId f) { return plane_of(before, f, tubes.apex); });
    state.add_areas(parts, after, tree_after, tubes, t, axis,
                    [&](FacetId f) { return plane_of(after, f, tubes.apex); });
    ledger.count(Law::facet_splitting, of.number, whole.cones && parts == whole);
  }
}

void check_law(Prover::State& state, const Case& of, Law law, Random& random, Ledger& ledger) {
  const SmallScene& scene = of.scene;
  switch (law) {
    case Law::closure:
      return;  // for each tube, in Prover::check
    case Law::filtered:
      return compare_hashes(state, of, scene.mesh, scene.tubes, law, ledger, Arithmetic::filtered);
    case Law::rational:
      return compare_hashes(state, of, scene.mesh, scene.tubes, law, ledger, Arithmetic::rational);
    case Law::facet_order:
      return compare_hashes(state, of, shuffled(random, scene.mesh), scene.tubes, law, ledger);
    case Law::inner_splitting:
      return compare_hashes(state, of, scene.mesh, scene.tubes, law, ledger, Arithmetic::fixed,
                            random.one_in(3) ? 1000000 : static_cast<std::uint32_t>(random.between(1, 3)));
    case Law::translation: {
      constexpr std::int32_t end = (1 << WorldGrid::coordinate_bits) - 1;
      TubeSet tubes = scene.tubes;
      tubes.apex = {random.between(-end, end), random.between(-end, end), random.between(-end, end)};
      FacetMesh mesh = scene.mesh;
      for (GridPoint& p : mesh.vertices) {
        const GridPoint d = p - scene.tubes.apex;
        p = {tubes.apex.x + d.x, tubes.apex.y + d.y, tubes.apex.z + d.z};
      }
      return compare_hashes(state, of, mesh, tubes, law, ledger);
    }
    case Law::tube_splitting:
      return check_tube_splitting(state, of, random, ledger);
    case Law::facet_splitting:
      return check_facet_splitting(state, of, random, ledger);
    case Law::predicate:
      for (std::uint32_t t = 0; t < tubes_per_scene; ++t)
        ledger.count(law, of.number, state.signs.obey_laws(scene.mesh, scene.tubes, t, random));
  }
}

}  // namespace

Prover::Prover() : state_(std::make_unique<State>()) {}
Prover::~Prover() = default;
Prover::Prover(Prover&&) noexcept = default;

void Prover::check(std::uint64_t seed, std::uint64_t number, Ledger& ledger, bool all) {
  const SmallScene scene = make_scene(seed, number);
  const SceneTree tree(scene.mesh);
  Case of{scene, tree, number};
  for (std::uint32_t t = 0; t < tubes_per_scene; ++t) {
    state_->look(scene.mesh, tree, scene.tubes, t);
    const TubeAudit found = audit(scene.mesh, scene.tubes, t, state_->seen, of.label(t));
    of.hashes[t] = found.hash;
    ledger.count(Law::closure, number, found.closes);
    ledger.hash += found.hash;
    ledger.facets_seen[number % generator_names.size()] += found.facets;
    ledger.tubes_with_facets[number % generator_names.size()] += found.facets > 0;
  }
  const Law turn = turns[number / generator_names.size() % turns.size()];
  for (std::size_t l = 0; l < law_names.size(); ++l) {
    const Law law = static_cast<Law>(l);
    if (!all && law != turn) continue;
    Random random(~seed, number);  // not the stream that made the scene
    check_law(*state_, of, law, random, ledger);
  }
}

}  // namespace tubefoot::prove
