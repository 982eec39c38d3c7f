// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/footprints/shared_footprints.hpp"
#include "geometry/visibility/closure.hpp"

namespace tubefoot {

/// Result of checking the visibility of two apexes, in rationals. It has the closure law of all tubes of
/// both, and the law of shared parts for each facet that both see.
struct BistaticAudit {
  std::vector<TubeAudit> transmit, receive;
  std::vector<SharedAudit> shared;
};

/// Checks all tubes of a set. `label` identifies the set; each tube gets a label derived from it. `seen` must
/// include the unobstructed regions.
std::vector<TubeAudit> audit_tubes(const FacetMesh& mesh, const TubeSet& tubes,
                                   std::span<const TubeVisibility> seen, std::uint64_t label);
std::vector<SharedAudit> audit_shared(const FootprintSharer& sharer, std::uint64_t label);

}  // namespace tubefoot
