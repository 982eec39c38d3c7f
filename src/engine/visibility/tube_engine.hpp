// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "engine/visibility/history.hpp"
#include "geometry/search/scene_tree.hpp"
#include "geometry/visibility/closure.hpp"
#include "geometry/visibility/visibility.hpp"

namespace tubefoot {

/// The exact engine: tubes in, footprints out. Thread-safe; a ping's tubes are dealt to the threads that are
/// free, and the result does not depend on them.
class TubeEngine {
 public:
  TubeEngine(const FacetMesh& mesh, const SceneTree& tree, double grid_unit_m,
             const VisibilityOptions& options);
  ~TubeEngine();

  /// Footprints of one ping. `candidates`, if given, receives the number of facets looked at. Areas,
  /// centroids and the other measures are left out if they are not wanted: exact binning does without. With
  /// `wanted`, by tube, the others have no footprints; all keep their numbers.
  History trace(TubeSet tubes, std::size_t* candidates = nullptr, bool measured = true,
                const std::vector<bool>& wanted = {}) const;

  /// The closure law for every tube of a ping; `label` tells pings apart in the hash.
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
