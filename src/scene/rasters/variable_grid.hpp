// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "files/bag_refinements.hpp"
#include "files/input_error.hpp"
#include "scene/description/scene_component.hpp"

namespace tubefoot {

/// A part of a grid of variable resolution, in the plane of its CRS.
struct VariableGrid {
  const BagRefinements& refinements;
  double west, south, cell_x, cell_y;  ///< of the overview: its corner, the sizes of its cells
  std::size_t column, row;             ///< the part's south-west cell
  std::size_t columns, rows;
};

/// A vertex at every node that has data. Within a supergrid facets lie between neighbouring nodes, as in any
/// raster. Between two supergrids a row of triangles joins all nodes along both sides of the border, and
/// where four meet, their corners are joined: no vertex lies within another facet's edge, so no crack opens.
/// Where a node or a supergrid has no data there is a hole, and `hole_cells` counts what is missing, of which
/// supergrids without any node count one each.
///
/// Heights are the file's values. Throws InputError for nodes of a supergrid that lie outside of its own
/// cell.
ComponentMesh join_supergrids(const VariableGrid& grid, const SourcePlace& place);

/// Heights of the surface that the facets form, at the centres of square cells of `step` from the grid's
/// south-west corner on: points and facets of a raster of one resolution. What of a cell has no surface is a
/// hole. Throws InputError for less than 2 x 2 cells; how many are too many is the caller's to say.
ComponentMesh resampled(const ComponentMesh& surface, const VariableGrid& grid, double step,
                        const SourcePlace& place);

}  // namespace tubefoot
