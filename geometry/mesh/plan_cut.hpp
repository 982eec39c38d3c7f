// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace tubefoot {

/// Maximum number of crossings between segments. Each crossing takes some 60 us and becomes a vertex. One
/// additional crossing is permitted per `segments_per_crossing` segments.
inline constexpr std::size_t most_plan_crossings = 50'000, segments_per_crossing = 8;

/// A line segment on a chart: x east, y north.
struct PlanSegment {
  glm::dvec2 a, b;
};

constexpr std::size_t crossings_allowed(std::size_t segments) {
  return most_plan_crossings + segments / segments_per_crossing;
}

/// A mesh in which every facet lies on one side of every segment.
struct PlanCut {
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< the parts of a facet are contiguous
  std::vector<std::uint32_t> facet;                     ///< per triangle: the facet of which it is a part
  std::size_t cut_facets = 0;
};

/// Cuts facets along vertical walls above and below segments, which may touch, cross and overlap each other.
/// The parts of a facet have its orientation. Facets that no segment enters stay as they are, in their order.
///
/// At the intersection of a wall with an edge, every facet of that edge gets the same new vertex. It is
/// computed in rationals from the two lines alone and rounded once, so a mesh without T-junctions stays
/// without T-junctions. New vertices are appended to `points`; their height is that of the facet's plane.
///
/// Throws std::domain_error if a segment meets a vertical facet, which has no interior in plan view. Throws
/// std::length_error for more than 2^31 parts or vertices, or if segments cross each other more than
/// crossings_allowed() times on the mesh.
///
/// Law U1 (sides): every part lies on one side of every segment, and the parts of a facet fill it.
///
/// Law U2 (sheet): a mesh without T-junctions stays without T-junctions.
PlanCut cut_in_plan(std::vector<glm::dvec3>& points,
                    const std::vector<std::array<std::uint32_t, 3>>& triangles,
                    std::span<const PlanSegment> segments);

}  // namespace tubefoot
