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

// The walls of a piece: planes through the apex and two neighbouring corners. Heavy: include only in .cpp
// files.
namespace tubefoot {

/// The one plane that two corners surely share, by name.
std::optional<PlaneName> shared_plane(const CornerName& x, const CornerName& y);

/// An inward normal of the wall from corner k of a piece to the next: of the plane that both share by name,
/// whose coefficients have 156 bits at most, if that tells on which side the piece is; else from their
/// directions, 630 bits. `points`: of the corners, as point_on_facet() has them.
std::array<HugeInt, 3> inward_normal(const NameContext& context, std::span<const CornerName> corners,
                                     std::uint32_t k, std::span<const glm::dvec3> points);

}  // namespace tubefoot
