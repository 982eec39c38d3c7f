// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "engine/visibility/history.hpp"
#include "geometry/footprints/shared_footprints.hpp"
#include "geometry/visibility/visibility.hpp"

// Conversion of the visible pieces of tubes (look(), bistatic_history.hpp) to histories. The results do not
// depend on the threads.
namespace tubefoot {

/// Returns the footprints of one apex, with measures, as TubeEngine::trace() does.
History history_of(const FacetMesh& mesh, TubeSet tubes, std::span<const TubeVisibility> seen,
                   double grid_unit_m);

/// Returns the common visibility of two apexes: FootprintSharer::all(), computed by all threads.
SharedFootprints shared_by_all(const FootprintSharer& sharer);

}  // namespace tubefoot
