// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "geometry/numbers/world_grid.hpp"

namespace tubefoot {

using VertexId = std::uint32_t;
using FacetId = std::uint32_t;
constexpr FacetId no_facet = 0xffffffffu;

/// Facets of the whole scene on the world grid: a set of triangles with shared vertices, not necessarily a
/// manifold. Vertices at the same grid point have the same id (see MeshBuilder), so shared edges are
/// recognised by id.
struct FacetMesh {
  std::vector<GridPoint> vertices;
  std::vector<std::array<VertexId, 3>> facets;
  /// Per facet: index into the scene's materials, and into its components (terrain, objects).
  std::vector<std::uint16_t> material;
  std::vector<std::uint16_t> component;
};

/// Results of snapping and welding. No facet is removed.
struct MeshReport {
  double largest_snap_m = 0;          ///< largest displacement of a vertex by snapping
  std::size_t degenerate_facets = 0;  ///< zero area on the grid: kept, but they subtend nothing
  std::size_t duplicate_facets = 0;   ///< same three vertices as an earlier facet: kept, wins_tie() decides
};

/// Collects components in one FacetMesh: snaps points to the grid, welds equal grid points and counts.
class MeshBuilder {
 public:
  explicit MeshBuilder(const WorldGrid& grid);
  ~MeshBuilder();
  MeshBuilder(const MeshBuilder&) = delete;
  MeshBuilder& operator=(const MeshBuilder&) = delete;

  /// Adds one component. `points_m` are in the local frame; `triangles` are indices of `points_m`. Throws
  /// GridRangeError for a point outside the grid, std::out_of_range for an invalid index.
  void add(const std::vector<glm::dvec3>& points_m,
           const std::vector<std::array<std::uint32_t, 3>>& triangles, std::uint16_t material,
           std::uint16_t component);

  /// Returns the mesh and its report. The builder is empty afterwards.
  FacetMesh finish(MeshReport& report);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Returns true if the three grid points are collinear (exact).
bool is_degenerate(GridPoint a, GridPoint b, GridPoint c);

}  // namespace tubefoot
