// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "engine/visibility/bistatic_history.hpp"
#include "geometry/footprints/footprint.hpp"

namespace tubefoot {

/// The common visibility of two apexes as footprints: one per tube of the transmit leg, tube of the receive
/// leg and facet, in that order. The shared facets of the history are these footprints, with the same
/// numbers, which CommonVisibility uses too.
struct PathFootprints {
  BistaticHistory history;
  /// Footprints at the positions that the transmit leg sees. Their slant ranges are half path lengths, of the
  /// shortest and the longest path. In stratified water these are the lengths for the flattened facet
  /// (BistaticFacet). There are no occluders.
  FootprintSet footprints;
  std::vector<std::uint32_t> receive_tube;  ///< per footprint
  std::vector<double> receive_distance_m;   ///< distance of the receive leg's apex from the facet's plane

  /// Returns the true position of a point of a footprint with the apparent position `seen_m`, relative to the
  /// apex of the transmit leg; local frame.
  glm::dvec3 place(std::size_t footprint, glm::dvec3 seen_m, glm::dvec3 apex_m) const;
  /// Returns the area at the true position.
  double area_m2(std::size_t footprint) const;
};

/// Divides the shared facets of a history into footprints. The sum of the energies does not change.
PathFootprints path_footprints(const BistaticHistory& history);

}  // namespace tubefoot
