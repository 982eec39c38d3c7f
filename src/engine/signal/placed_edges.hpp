// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace tubefoot {

/// Per point: the first point at the same position. Formats without shared vertices repeat points.
std::vector<std::uint32_t> first_of_same_place(std::span<const glm::dvec3> points);

/// Edges of a mesh, with points at the same position identified.
struct PlacedEdges {
  struct Edge {
    std::uint32_t from = 0, to = 0;
    std::array<std::uint32_t, 2> facets{};
    bool is_shared = false;  ///< exactly two facets; else `facets[0]` and any number of others
    bool same_way = false;   ///< both facets traverse the edge in the same direction
  };
  std::vector<Edge> edges;

  PlacedEdges(std::span<const glm::dvec3> points, std::span<const std::array<std::uint32_t, 3>> triangles);
};

}  // namespace tubefoot
