// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "files/bag_refinements.hpp"
#include "files/input_error.hpp"
#include "scene/description/scene_component.hpp"

namespace tubefoot {

/// A part of a grid of variable resolution, in the plane of its CRS.
struct VariableGrid {
  const BagRefinements& refinements;
  double west, south, cell_x, cell_y;  ///< of the overview: its corner and the sizes of its cells
  std::size_t column, row;             ///< south-west cell of the part
  std::size_t columns, rows;
};

/// Returns the facets between the nodes of all supergrids, with a vertex at every node that has data.
/// Within a supergrid facets join neighbouring nodes, as in any raster. Between two supergrids a strip of
/// triangles joins all nodes along both sides of the border. Triangles also join the corners of four
/// supergrids that meet. No vertex lies within the edge of another facet, so that there are no cracks.
///
/// Nodes and supergrids without data leave holes, which `hole_cells` counts. A supergrid without nodes
/// counts as one. Heights are the values of the file. Throws InputError for nodes of a supergrid outside of
/// its own cell.
ComponentMesh join_supergrids(const VariableGrid& grid, const SourcePlace& place);

/// Returns the points and facets of a raster with one resolution. Its heights are those of the surface at
/// the centres of square cells of size `step`, from the grid's south-west corner on. Cell centres without a
/// surface are holes. Throws InputError for fewer than 2 x 2 cells. The caller limits the number of cells.
ComponentMesh resampled(const ComponentMesh& surface, const VariableGrid& grid, double step,
                        const SourcePlace& place);

}  // namespace tubefoot
