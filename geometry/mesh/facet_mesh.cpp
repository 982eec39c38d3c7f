// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh/facet_mesh.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <stdexcept>

#include "geometry/mesh/weld_table.hpp"
#include "geometry/numbers/int128.hpp"
#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

std::size_t count_duplicates(const std::vector<std::array<VertexId, 3>>& facets) {
  std::vector<std::array<VertexId, 3>> keys = facets;
  for (auto& key : keys) std::sort(key.begin(), key.end());
  std::sort(keys.begin(), keys.end());
  const auto distinct = std::unique(keys.begin(), keys.end()) - keys.begin();
  return keys.size() - static_cast<std::size_t>(distinct);
}

}  // namespace

struct MeshBuilder::State {
  explicit State(const WorldGrid& world_grid) : grid(world_grid), weld(mesh.vertices) {}

  WorldGrid grid;
  FacetMesh mesh;
  WeldTable weld;
  MeshReport report;
};

MeshBuilder::MeshBuilder(const WorldGrid& grid) : state_(std::make_unique<State>(grid)) {}
MeshBuilder::~MeshBuilder() = default;

void MeshBuilder::add(const std::vector<glm::dvec3>& points_m,
                      const std::vector<std::array<std::uint32_t, 3>>& triangles, std::uint16_t material,
                      std::uint16_t component) {
  State& s = *state_;
  for (const auto& triangle : triangles) {
    for (const std::uint32_t index : triangle) {
      if (index >= points_m.size()) {
        throw std::out_of_range(
            fmt::format("a facet refers to point {}, but the mesh has {} points", index, points_m.size()));
      }
    }
  }
  s.weld.reserve(s.mesh.vertices.size() + points_m.size());
  std::vector<VertexId> id(points_m.size());
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    stop_if_wanted();
    const GridPoint p = s.grid.snap(points_m[i]);
    id[i] = s.weld.id_of(p);
    s.report.largest_snap_m =
        std::max(s.report.largest_snap_m, glm::distance(points_m[i], s.grid.to_metres(p)));
  }
  const std::size_t facets = s.mesh.facets.size() + triangles.size();
  for (const auto& [a, b, c] : triangles) {
    stop_if_wanted();
    s.mesh.facets.push_back({id[a], id[b], id[c]});
    const auto& v = s.mesh.vertices;
    if (is_degenerate(v[id[a]], v[id[b]], v[id[c]])) ++s.report.degenerate_facets;
  }
  s.mesh.material.resize(facets, material);
  s.mesh.component.resize(facets, component);
}

FacetMesh MeshBuilder::finish(MeshReport& report) {
  State& s = *state_;
  s.report.duplicate_facets = count_duplicates(s.mesh.facets);
  report = s.report;
  FacetMesh mesh = std::move(s.mesh);
  state_ = std::make_unique<State>(WorldGrid(s.grid));
  return mesh;
}

bool is_degenerate(GridPoint a, GridPoint b, GridPoint c) {
  // Differences of 32-bit integers have 33 bits and their products have 66, more than int64 holds.
  const Int128 ux = std::int64_t{b.x} - a.x, uy = std::int64_t{b.y} - a.y, uz = std::int64_t{b.z} - a.z;
  const Int128 vx = std::int64_t{c.x} - a.x, vy = std::int64_t{c.y} - a.y, vz = std::int64_t{c.z} - a.z;
  return uy * vz == uz * vy && uz * vx == ux * vz && ux * vy == uy * vx;
}

}  // namespace tubefoot
