// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/visibility/bistatic_audit.hpp"

#include <tbb/parallel_for.h>

#include "engine/visibility/part_label.hpp"
#include "geometry/steps/stop.hpp"

namespace tubefoot {

std::vector<TubeAudit> audit_tubes(const FacetMesh& mesh, const TubeSet& tubes,
                                   std::span<const TubeVisibility> seen, std::uint64_t label) {
  std::vector<TubeAudit> audits(seen.size());
  tbb::parallel_for(std::size_t{0}, seen.size(), [&](std::size_t tube) {
    stop_if_wanted();
    audits[tube] =
        audit(mesh, tubes, static_cast<std::uint32_t>(tube), seen[tube], label_of_part(label, tube));
  });
  return audits;
}

std::vector<SharedAudit> audit_shared(const FootprintSharer& sharer, std::uint64_t label) {
  std::vector<SharedAudit> audits(sharer.facets());
  tbb::parallel_for(std::size_t{0}, audits.size(),
                    [&](std::size_t number) { audits[number] = sharer.audit(number, label); });
  return audits;
}

}  // namespace tubefoot
