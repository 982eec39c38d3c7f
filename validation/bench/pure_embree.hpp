// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "geometry/mesh/facet_mesh.hpp"
#include "geometry/tubes/tube.hpp"

/// Upper limit of the speed of the ray engine: Embree alone, on a square of precomputed rays in blocks of
/// four by four. Hits are counted and not processed.
class PureEmbree {
 public:
  /// Prepares `side` x `side` jittered rays in the first tube; `side` must be a multiple of four.
  PureEmbree(const tubefoot::FacetMesh& mesh, const tubefoot::TubeSet& tubes, double unit_m, int side);
  ~PureEmbree();
  /// Traces all rays and returns the number of hits.
  long trace() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};
