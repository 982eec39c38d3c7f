// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>

#include "prove/ledger.hpp"

// The laws of docs/notes/visibility.md as checks of one scene. The tests and tubefoot_prove share them.
namespace tubefoot::prove {

/// Prover of one thread, which keeps its buffers from scene to scene. It checks these laws:
///
/// - closure (C1): pieces and open water add up to the tube, as rationals.
/// - filtered = fixed, rational = fixed (V2): the other arithmetic closes, and gives the same areas of the
///   same facets (hash, C2).
/// - predicate (A1 to A6, A8): on planes of the scene (walls, edges, depth planes), `rational`, `fixed` and
///   `filtered` give det(n1, n2, n3) the same sign, and so does the last tier of either alone. The sign is
///   cyclic, antisymmetric, changes with each normal, and is 0 on the planes of a corner. The same holds for
///   points against planes and facets.
/// - facet order (V3): a permutation of facets, their vertices and vertex indices gives the same hash, with
///   shared vertices or not.
/// - translation (V4): a scene and apex that are moved by a grid vector have the same hash.
/// - tube splitting (V6): a plane through rays in opposite walls cuts a tube in two. Per facet, and for open
///   water, the areas of the parts add up, as rationals.
/// - facet splitting (V7): facets of an edge (all, or one: a T-junction) are cut at its midpoint. The areas
///   per plane stay the same, as rationals.
/// - inner splitting (V8): VisibilityOptions::facets_per_split gives the same hash.
class Prover {
 public:
  Prover();
  ~Prover();
  Prover(Prover&&) noexcept;

  /// Checks closure on each tube of the scene, and one other law that the number of the scene selects. With
  /// `all` it checks each law.
  void check(std::uint64_t seed, std::uint64_t scene, Ledger& ledger, bool all = false);

  struct State;

 private:
  std::unique_ptr<State> state_;
};

}  // namespace tubefoot::prove
