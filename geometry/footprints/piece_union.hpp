// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "geometry/footprints/footprint.hpp"

namespace tubefoot {

/// A polygon with holes: rings of corner numbers, the outer one first, counter-clockwise as the pieces are;
/// holes turn the other way. No ring comes to a corner twice.
using RingedPolygon = std::vector<std::vector<std::uint32_t>>;

/// Convex pieces of one plane with disjoint interiors as the polygons that they make together: what two
/// pieces share of their borders is gone, where one's corner lies on another's edge that edge has it too.
/// Nothing is computed anew: all corners are corners of the pieces. Polygons touch each other, and their
/// holes touch them and each other, in single corners at most, and the inside of each is connected (as OGC
/// simple features want it). Corners closer than 1e-11 of the coordinates' size are one corner.
///
/// Nothing if the pieces' borders do not close once those they share are gone: they overlap, or are slivers
/// that rounding folded over.
std::optional<std::vector<RingedPolygon>> united(std::span<const glm::dvec3> corners,
                                                 std::span<const Piece> pieces);

}  // namespace tubefoot
