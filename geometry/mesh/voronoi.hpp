// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

namespace tubefoot {

/// The line between the cells of two sites.
struct VoronoiEdge {
  std::uint32_t site, other_site;
  glm::dvec2 a, b;
};

/// The finite edges of the Voronoi diagram of distinct sites. The diagram's topology is exact; its vertices
/// are rounded, each once, so that the edges about it meet in the very same point.
/// Law U3 (Voronoi): an edge lies midway between its two sites, and no site is nearer to it.
std::vector<VoronoiEdge> voronoi_edges(std::span<const glm::dvec2> sites);

}  // namespace tubefoot
