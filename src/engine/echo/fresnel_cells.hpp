// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "engine/echo/shadow_edges.hpp"
#include "geometry/search/scene_tree.hpp"
#include "geometry/visibility/visibility.hpp"

// Weights of the energies near shadow borders, shadow = "fresnel" (docs/energies.md). Cells with constant
// factors approximate the change that diffraction causes. integrate_echo() integrates their echo as that of
// facets.
namespace tubefoot {

/// Largest difference of Fresnel parameters within a cell. Factors are means over cells, so the error of an
/// energy over several cells is of second order.
constexpr double fresnel_cell_step = 0.04;

/// Parts of facets with a factor each. The echo of the cells, added to that of the visible footprints, is the
/// echo with Fresnel weights.
struct FresnelCells {
  /// One footprint per cell, whose `facet` is the number of the cell, without measures. `tubes` is empty.
  History history;
  std::vector<FacetId> facet;  ///< by cell: the facet of the mesh on which it lies
  /// By cell: the mean of I(nu)^2 - 1 on the insonified side of a border, and of I(nu)^2 in the shadow. I is
  /// knife_edge_intensity().
  std::vector<double> factor;
};

/// The surface that one apex sees, for fresnel_cells().
struct FresnelSurface {
  const FacetMesh& mesh;
  const SceneTree& tree;
  const VisibilityOptions& options;
  /// Whether a component is a terrain, whose hills cast shadows on the terrain itself.
  std::function<bool(std::uint16_t component)> is_terrain;
};

/// Returns the cells of a history for equal transmit and receive legs. `edges`: shadow_edges() of the
/// history.
///
/// Insonified side: nu is that of the edge of a component with the smallest |nu|. The factors of different
/// components are multiplied. An edge acts on places that lie behind it by at least one wavelength. Their
/// projections on the plane of apex and edge lie behind the edge itself.
///
/// Hidden side: the surface is traced again, in the strip behind each edge, without the component that casts
/// the shadow. Only some facets of a terrain are omitted: those in front of the edge, and those of which the
/// apex sees the other side. Places behind two components receive no energy.
///
/// The result does not depend on the threads. `edge_step`: see fresnel_cell_step.
FresnelCells fresnel_cells(const FresnelSurface& surface, const History& history,
                           std::span<const ShadowEdge> edges, double wavelength_m,
                           double cell_step = fresnel_cell_step);

}  // namespace tubefoot
