// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/footprints/shared_footprints.hpp"
#include "geometry/visibility/closure.hpp"

namespace tubefoot {

/// What holds of what two apexes see, in rationals: the closure law of all tubes of both, and, by facet that
/// both look at, that of the parts that they share.
struct BistaticAudit {
  std::vector<TubeAudit> transmit, receive;
  std::vector<SharedAudit> shared;
};

/// Of all tubes of a set, parts of what `label` is of. `seen`: with open water.
std::vector<TubeAudit> audit_tubes(const FacetMesh& mesh, const TubeSet& tubes,
                                   std::span<const TubeVisibility> seen, std::uint64_t label);
std::vector<SharedAudit> audit_shared(const FootprintSharer& sharer, std::uint64_t label);

}  // namespace tubefoot
