// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh/closed_shells.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

namespace tubefoot {

ClosedShells::ClosedShells(const FacetMesh& mesh, std::uint16_t component) {
  std::vector<std::pair<std::array<VertexId, 3>, FacetId>> own;
  for (FacetId id = 0; id < mesh.facets.size(); ++id) {
    if (mesh.component[id] != component) continue;
    std::array<VertexId, 3> corners = mesh.facets[id];
    std::ranges::sort(corners);
    own.emplace_back(corners, id);
  }
  std::ranges::sort(own);
  const auto repeated =
      std::unique(own.begin(), own.end(), [](const auto& a, const auto& b) { return a.first == b.first; });
  own.erase(repeated, own.end());

  // Edges with their adjacent facets, sorted by edge. An edge from a vertex to itself is omitted.
  std::vector<std::pair<std::array<VertexId, 2>, std::uint32_t>> edges;
  edges.reserve(3 * own.size());
  for (std::uint32_t k = 0; k < own.size(); ++k) {
    const auto& [a, b, c] = own[k].first;
    for (const std::array<VertexId, 2>& edge : {std::array{a, b}, {b, c}, {a, c}})
      if (edge[0] != edge[1]) edges.emplace_back(edge, k);
  }
  std::ranges::sort(edges);

  std::vector<std::uint32_t> root(own.size());
  std::iota(root.begin(), root.end(), 0u);
  const auto root_of = [&](std::uint32_t k) {
    while (root[k] != k) k = root[k] = root[root[k]];
    return k;
  };
  std::vector<std::uint32_t> odd;  // a facet of each edge that belongs to an odd number of facets
  for (std::size_t first = 0, end = 0; first < edges.size(); first = end) {
    for (end = first; end < edges.size() && edges[end].first == edges[first].first; ++end) {
      // The lower number is the root, so that the numbering of shells follows the facets and not the order of
      // edges.
      const std::uint32_t a = root_of(edges[first].second), b = root_of(edges[end].second);
      root[std::max(a, b)] = std::min(a, b);
    }
    if ((end - first) % 2 == 1) odd.push_back(edges[first].second);
  }
  constexpr std::uint32_t open = std::numeric_limits<std::uint32_t>::max(), unnumbered = open - 1;
  std::vector<std::uint32_t> number(own.size(), unnumbered);
  for (const std::uint32_t k : odd) number[root_of(k)] = open;
  for (std::uint32_t k = 0; k < own.size(); ++k) {
    std::uint32_t& shell = number[root_of(k)];
    if (shell == unnumbered) shell = static_cast<std::uint32_t>(count_++);
    if (shell != open) shells_.emplace_back(own[k].second, shell);
  }
  std::ranges::sort(shells_);
}

std::optional<std::uint32_t> ClosedShells::shell_of(FacetId facet) const {
  const auto found = std::ranges::lower_bound(shells_, facet, {}, &std::pair<FacetId, std::uint32_t>::first);
  if (found == shells_.end() || found->first != facet) return std::nullopt;
  return found->second;
}

}  // namespace tubefoot
