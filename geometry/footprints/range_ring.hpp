// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <vector>

// Where half paths have one length on a facet's plane: polygons in place of curves. docs/coverage.md
namespace tubefoot {

/// Sides of the polygons.
inline constexpr int ring_sides = 96;
/// Smaller rings are not drawn: their corners, rounded to the grid, might not be convex. Grid units.
inline constexpr double least_ring = 8192;

enum class RingSide { inscribed, circumscribed };

/// Corners of a polygon in (or about) the circle on a plane at a range from an apex, counter-clockwise about
/// the plane's normal and relative to `corner`; empty where there is none. `corner`: of the plane, relative
/// to the apex; grid units. `first`: a direction in the plane.
std::vector<glm::dvec3> range_ring(glm::dvec3 corner, glm::dvec3 normal, glm::dvec3 first, double range,
                                   RingSide side);

/// The same of half paths between two apexes, to points of a facet that both see, the second perhaps as
/// another image: corners relative to each. Half paths are a convex function of the facet's points, so that
/// the curve has an inside. On the first image, relative to its first corner, turning as its corners do.
std::vector<glm::dvec3> half_path_ring(const std::array<glm::dvec3, 3>& tx,
                                       const std::array<glm::dvec3, 3>& rx, double half_path, RingSide side);

}  // namespace tubefoot
