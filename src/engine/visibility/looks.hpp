// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "engine/visibility/history.hpp"
#include "geometry/footprints/shared_footprints.hpp"
#include "geometry/visibility/visibility.hpp"

// What is reported of tubes that have looked (look(), bistatic_history.hpp). No result depends on the
// threads.
namespace tubefoot {

/// What an apex sees by itself, with measures: as TubeEngine::trace().
History history_of(const FacetMesh& mesh, TubeSet tubes, std::span<const TubeVisibility> seen,
                   double grid_unit_m);

/// What two apexes see together: FootprintSharer::all(), by all threads.
SharedFootprints shared_by_all(const FootprintSharer& sharer);

}  // namespace tubefoot
