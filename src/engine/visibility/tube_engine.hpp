// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "engine/visibility/history.hpp"
#include "geometry/search/scene_tree.hpp"
#include "geometry/visibility/closure.hpp"
#include "geometry/visibility/visibility.hpp"

namespace tubefoot {

/// The exact engine, which computes the footprints of tubes. Thread-safe. The tubes of a ping are distributed
/// among the free threads, and the result does not depend on them.
class TubeEngine {
 public:
  TubeEngine(const FacetMesh& mesh, const SceneTree& tree, double grid_unit_m,
             const VisibilityOptions& options);
  ~TubeEngine();

  /// Computes the footprints of one ping. `candidates`, if not null, is increased by the number of candidate
  /// facets. `measured` selects whether areas, centroids and the other measures are computed; exact binning
  /// does not need them. With `wanted`, per tube, the other tubes have no footprints; all tubes keep their
  /// numbers.
  History trace(TubeSet tubes, std::size_t* candidates = nullptr, bool measured = true,
                const std::vector<bool>& wanted = {}) const;

  /// Checks the closure law for every tube of a ping. `label` distinguishes pings in the hash.
  std::vector<TubeAudit> audit(const TubeSet& tubes, std::uint64_t label) const;

 private:
  struct Scratch;
  const FacetMesh& mesh_;
  const SceneTree& tree_;
  double grid_unit_m_;
  VisibilityOptions options_;
  std::unique_ptr<Scratch> scratch_;
};

}  // namespace tubefoot
