// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "geometry/footprints/footprint.hpp"

namespace tubefoot {

/// A polygon with holes, as rings of corner numbers. The outer ring comes first, counter-clockwise as the
/// pieces are; holes turn the other way. No ring contains a corner twice.
using RingedPolygon = std::vector<std::vector<std::uint32_t>>;

/// Unites convex pieces of one plane with disjoint interiors to polygons. Borders that two pieces share are
/// removed. An edge on which the corner of another piece lies gets this corner too. All corners are corners
/// of the pieces; no coordinates are computed.
///
/// Polygons and holes touch each other at most in single corners, and the interior of each polygon is
/// connected, as OGC simple features require. Corners closer than 1e-11 of the coordinates' size are one
/// corner.
///
/// Returns nothing if the borders of the pieces do not close after the shared ones are removed. The pieces
/// then overlap, or they are slivers that rounding has folded over.
std::optional<std::vector<RingedPolygon>> united(std::span<const glm::dvec3> corners,
                                                 std::span<const Piece> pieces);

}  // namespace tubefoot
