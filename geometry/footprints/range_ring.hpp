// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <vector>

// Curves of equal half path length on a facet's plane, replaced by polygons (docs/notes/coverage.md).
namespace tubefoot {

/// Number of sides of the polygons.
inline constexpr int ring_sides = 96;
/// Smaller rings are omitted on charts of the grid, because their rounded corners might not be convex. Grid
/// units.
inline constexpr double least_ring = 8192;

enum class RingSide { inscribed, circumscribed };

/// Returns the corners of a polygon inscribed in or circumscribed about the circle of a given range from an
/// apex on a plane. The corners are counter-clockwise about the plane's normal and relative to `corner`. The
/// result is empty if there is no circle of a radius above `least`. `corner` is a point of the plane relative
/// to the apex, in grid units. `first` is a direction in the plane.
std::vector<glm::dvec3> range_ring(glm::dvec3 corner, glm::dvec3 normal, glm::dvec3 first, double range,
                                   RingSide side, double least);

/// Returns the polygon for half path lengths between two apexes and the points of a facet that both see. The
/// second apex may see the facet as another image; the corners are relative to each apex. The half path
/// length is a convex function on the facet, so the curve has an interior. The result lies on the first
/// image, relative to its first corner, and turns as its corners do.
std::vector<glm::dvec3> half_path_ring(const std::array<glm::dvec3, 3>& tx,
                                       const std::array<glm::dvec3, 3>& rx, double half_path, RingSide side,
                                       double least);

}  // namespace tubefoot
