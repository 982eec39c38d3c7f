// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/signal/placed_edges.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace tubefoot {

std::vector<std::uint32_t> first_of_same_place(std::span<const glm::dvec3> points) {
  std::vector<std::uint32_t> order(points.size()), first(points.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const glm::dvec3 &p = points[a], &q = points[b];
    return std::array{p.x, p.y, p.z} < std::array{q.x, q.y, q.z};
  });
  for (std::size_t k = 0; k < order.size(); ++k)
    first[order[k]] = k > 0 && points[order[k]] == points[order[k - 1]] ? first[order[k - 1]] : order[k];
  return first;
}

PlacedEdges::PlacedEdges(std::span<const glm::dvec3> points,
                         std::span<const std::array<std::uint32_t, 3>> triangles) {
  struct Side {
    std::uint32_t from, to, facet;
    bool forwards;
  };
  const std::vector<std::uint32_t> place = first_of_same_place(points);
  std::vector<Side> sides;
  for (std::uint32_t facet = 0; facet < triangles.size(); ++facet)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = place[triangles[facet][k]], b = place[triangles[facet][(k + 1) % 3]];
      if (a != b) sides.push_back({std::min(a, b), std::max(a, b), facet, a < b});
    }
  std::stable_sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::pair(a.from, a.to) < std::pair(b.from, b.to);
  });
  for (std::size_t k = 0; k < sides.size();) {
    std::size_t end = k + 1;
    while (end < sides.size() && sides[end].from == sides[k].from && sides[end].to == sides[k].to) ++end;
    Edge edge{sides[k].from, sides[k].to, {sides[k].facet, sides[k].facet}};
    if (end - k == 2) {
      edge.facets[1] = sides[k + 1].facet;
      edge.is_shared = true;
      edge.same_way = sides[k].forwards == sides[k + 1].forwards;
    }
    edges.push_back(edge);
    k = end;
  }
}

}  // namespace tubefoot
