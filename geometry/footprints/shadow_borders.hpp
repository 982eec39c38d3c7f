// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "geometry/tubes/tube.hpp"
#include "geometry/visibility/visibility.hpp"

namespace tubefoot {

/// A part of a border between a visible and a hidden part of a facet. It is the image of an edge of a nearer
/// facet. Lengths in grid units.
struct ShadowBorder {
  double length = 0;
  double to_edge = 0;      ///< distance from the apex to the edge, along the ray to the middle of the border
  double beyond_edge = 0;  ///< distance from the edge to the middle of the border
  /// Sine of the angle between the facet and the plane of the apex and the edge. A point of the facet at
  /// distance d from the border has the distance d * sine from this plane.
  double sine = 0;
};

/// Returns the shadow borders of visible pieces, without the borders of tubes and of the facets themselves.
/// An edge that lies on the facet has no shadow. Computes in double.
std::vector<ShadowBorder> shadow_borders(const FacetMesh& mesh, const TubeSet& tubes,
                                         std::span<const TubeVisibility> seen);

}  // namespace tubefoot
