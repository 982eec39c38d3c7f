// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace tubefoot {

/// By point: the first that lies in its place. Formats without shared vertices repeat them.
std::vector<std::uint32_t> first_of_same_place(std::span<const glm::dvec3> points);

/// Edges of a mesh by place: points that lie in one place are one.
struct PlacedEdges {
  struct Edge {
    std::uint32_t from = 0, to = 0;
    std::array<std::uint32_t, 2> facets{};
    bool is_shared = false;  ///< of just two facets; else of `facets[0]` and any number of others
    bool same_way = false;   ///< both facets go along it the same way
  };
  std::vector<Edge> edges;

  PlacedEdges(std::span<const glm::dvec3> points, std::span<const std::array<std::uint32_t, 3>> triangles);
};

}  // namespace tubefoot
