// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "engine/echo/fresnel_strips.hpp"
#include "engine/echo/shadow_edges.hpp"
#include "engine/visibility/bistatic_history.hpp"
#include "engine/visibility/history.hpp"

// Weights of the energies near shadow borders, shadow = "fresnel" (docs/energies.md). Cells with constant
// factors approximate the change that diffraction causes. integrate_echo() integrates their echo as that of
// facets.
namespace tubefoot {

/// Largest difference of Fresnel parameters within a cell, which increases by the factor 1 + nu / 2 in the
/// shadow. Factors are means over cells, so the error of an energy over several cells is of second order.
constexpr double fresnel_cell_step = 0.045;

/// Properties of cells, which are parts of facets. The echo of the cells, added to that of the visible
/// surface, is the echo with Fresnel weights.
struct FresnelCellList {
  std::vector<FacetId> facet;  ///< by cell: the facet of the mesh on which it lies
  /// By cell: the mean of the weight, minus 1 where the surface is visible. The weight is the product of the
  /// intensities of both legs (knife_edge_intensity()).
  std::vector<double> factor;
};

/// Cells for equal transmit and receive legs.
struct FresnelCells : FresnelCellList {
  /// One footprint per cell, whose `facet` is the number of the cell, without measures. `tubes` is empty.
  History history;
};

/// Cells for separate apexes.
struct FresnelPairCells : FresnelCellList {
  /// One shared facet per cell, whose `facet` is the number of the cell.
  BistaticHistory history;
};

/// How cells are passed on. They are discarded in blocks, so that memory does not grow with their number.
template <class Cells>
struct FresnelBlocks {
  std::function<void(const Cells& block)> take;
  std::size_t largest = std::size_t{1} << 17;  ///< number of cells per block
};

/// Passes on the cells of a history for equal transmit and receive legs. `edges`: shadow_edges() of the
/// history. Throws Interrupted if stop_wanted().
///
/// Insonified side: the parameter nu is that of the edge of a component with the smallest |nu|. The factors
/// of different components are multiplied. An edge acts on places that lie behind it by at least one
/// wavelength. Their projections on the plane of apex and edge lie behind the edge itself.
///
/// Hidden side: the surface is traced again, in the strip behind each edge, without the component that casts
/// the shadow (HiddenStrips). Places behind two components receive no energy. Visible places keep their
/// energy.
///
/// The result does not depend on the threads. `cell_step`: see fresnel_cell_step.
void fresnel_cells(const FresnelSurface& surface, const History& history, std::span<const ShadowEdge> edges,
                   double wavelength_m, const FresnelBlocks<FresnelCells>& blocks,
                   double cell_step = fresnel_cell_step);

/// Passes on the cells for a separate receiver. Each leg has its own edges and parameters, and the factors of
/// both legs are multiplied. A place that both legs see around the same component receives energy, too.
void fresnel_pair_cells(const FresnelSurface& surface, const TubeSet& transmit, const TubeSet& receive,
                        double wavelength_m, const FresnelBlocks<FresnelPairCells>& blocks,
                        double cell_step = fresnel_cell_step);

}  // namespace tubefoot
