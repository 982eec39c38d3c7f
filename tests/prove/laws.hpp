// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>

#include "prove/ledger.hpp"

// The laws of docs/visibility.md as checks of one scene, shared by the tests and by tubefoot_prove.
namespace tubefoot::prove {

/// One thread's prover: keeps its buffers from scene to scene.
///
/// closure (C1)           pieces and open water add up to the tube, as rationals
/// filtered = fixed, rational = fixed (V2)
///                        the other arithmetic closes, and sees the same areas of the same facets (hash, C2)
/// predicate (A1 to A6, A8)
///                        on planes of the scene (walls, edges, depth planes), `rational`, `fixed` and
///                        `filtered`, and the last tier of either by itself, give det(n1, n2, n3) one sign:
///                        cyclic, antisymmetric, turning with each normal, 0 on a corner's own planes; and
///                        the same for points against planes and facets
/// facet order (V3)       facets, their vertices and vertex ids shuffled, vertices shared or not: the same
///                        hash
/// translation (V4)       scene and apex moved by a grid vector: the same hash
/// tube splitting (V6)    a tube cut in two by a plane through rays in opposite walls: per facet, and of open
///                        water, the areas of the parts add up, as rationals
/// facet splitting (V7)   an edge's facets (all, or one: a T-junction) cut at the edge's midpoint: per plane,
///                        the same areas, as rationals
/// inner splitting (V8)   VisibilityOptions::facets_per_split: the same hash
class Prover {
 public:
  Prover();
  ~Prover();
  Prover(Prover&&) noexcept;

  /// Closure on every tube of the scene, and the one other law whose turn it is by the scene's number; or,
  /// with `all`, every law.
  void check(std::uint64_t seed, std::uint64_t scene, Ledger& ledger, bool all = false);

  struct State;

 private:
  std::unique_ptr<State> state_;
};

}  // namespace tubefoot::prove
