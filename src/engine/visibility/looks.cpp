// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/visibility/looks.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "geometry/footprints/footprint_builder.hpp"
#include "geometry/integrals/measure.hpp"

namespace tubefoot {

History history_of(const FacetMesh& mesh, TubeSet tubes, std::span<const TubeVisibility> seen,
                   double grid_unit_m) {
  std::vector<FootprintSet> of_tube(tubes.tubes.size());
  tbb::parallel_for(std::uint32_t{0}, static_cast<std::uint32_t>(of_tube.size()), [&](std::uint32_t tube) {
    append_footprints(mesh, tubes, tube, seen[tube], grid_unit_m, of_tube[tube]);
    measure(of_tube[tube]);
  });
  return {std::move(tubes), grid_unit_m, joined(of_tube), {}};
}

SharedFootprints shared_by_all(const FootprintSharer& sharer) {
  constexpr std::size_t facets_per_task = 32;  // does not affect the result
  std::vector<SharedFootprints> parts((sharer.facets() + facets_per_task - 1) / facets_per_task);
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t task) {
    const std::size_t end = std::min((task + 1) * facets_per_task, sharer.facets());
    for (std::size_t k = task * facets_per_task; k < end; ++k) sharer.append(k, parts[task]);
  });
  SharedFootprints shared = sharer.without_facets();
  for (const SharedFootprints& part : parts) append(shared, part);
  return shared;
}

}  // namespace tubefoot
