// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "geometry/mesh/facet_mesh.hpp"
#include "geometry/tubes/tube.hpp"

/// What the ray engine can be at best: Embree alone, on a square of rays that are ready in memory, in blocks
/// of four by four, hits counted and nothing made of them.
class PureEmbree {
 public:
  /// `side` x `side` jittered rays in the first tube; `side` a multiple of four.
  PureEmbree(const tubefoot::FacetMesh& mesh, const tubefoot::TubeSet& tubes, double unit_m, int side);
  ~PureEmbree();
  /// Traces all rays; the number of hits.
  long trace() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};
