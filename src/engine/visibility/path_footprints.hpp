// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "engine/visibility/bistatic_history.hpp"
#include "geometry/footprints/footprint.hpp"

namespace tubefoot {

/// What two apexes see together, told as footprints: one for each tube of the transmit leg, tube of the
/// receive leg and facet, in that order. The history's shared facets are these, number by number, so that
/// Sight numbers them so.
struct PathFootprints {
  BistaticHistory history;
  /// As the transmit leg sees them, where it sees them. But slant ranges are half paths, of the nearest and
  /// the farthest path; in refracting water those of the facet flattened (BistaticFacet). No occluders.
  FootprintSet footprints;
  std::vector<std::uint32_t> receive_tube;  ///< by footprint
  std::vector<double> receive_distance_m;   ///< of the apex of the receive leg from the facet's plane

  /// Where a point of a footprint lies that is seen there, relative to the apex of the transmit leg; local
  /// frame.
  glm::dvec3 place(std::size_t footprint, glm::dvec3 seen_m, glm::dvec3 apex_m) const;
  /// Area where it lies.
  double area_m2(std::size_t footprint) const;
};

/// Energies of a history and of its footprints are the same, added up.
PathFootprints path_footprints(const BistaticHistory& history);

}  // namespace tubefoot
