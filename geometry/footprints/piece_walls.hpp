// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>

#include "geometry/arithmetic/exact_corner.hpp"
#include "geometry/footprints/plane_lines.hpp"
#include "geometry/mesh/names.hpp"

// The walls of a piece: planes through the apex and two neighbouring corners. This header is expensive to
// compile: include it only in .cpp files.
namespace tubefoot {

/// Returns the one plane that two corners certainly share, by name.
std::optional<PlaneName> shared_plane(const CornerName& x, const CornerName& y);

/// Returns an inward normal of the wall from corner k of a piece to the next corner. If both corners share a
/// plane by name and the side of the piece is known, the normal is that of this plane. Its coefficients have
/// at most 156 bits. Otherwise it is computed from the directions of the corners, with 630 bits. `points` are
/// the corners as point_on_facet() returns them.
std::array<HugeInt, 3> inward_normal(const NameContext& context, std::span<const CornerName> corners,
                                     std::uint32_t k, std::span<const glm::dvec3> points);

}  // namespace tubefoot
