// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

namespace tubefoot {

/// The edge between the cells of two sites.
struct VoronoiEdge {
  std::uint32_t site, other_site;
  glm::dvec2 a, b;
};

/// Returns the finite edges of the Voronoi diagram of distinct sites. The diagram's topology is exact. Each
/// vertex is rounded once, so that its edges meet in the same point.
///
/// Law U3 (Voronoi): an edge has equal distance from its two sites, and no other site is nearer to it.
std::vector<VoronoiEdge> voronoi_edges(std::span<const glm::dvec2> sites);

}  // namespace tubefoot
