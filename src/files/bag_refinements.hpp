// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <limits>
#include <string>
#include <vector>

namespace tubefoot {

/// What a Bathymetric Attributed Grid of variable resolution holds beside its overview: in each cell of that
/// a grid of nodes of its own, here called a supergrid as GDAL does. Rows count from the south, columns from
/// the west, both of cells and of nodes. (Format Specification Document of BAG 2.0, "Variable Resolution")
struct BagRefinements {
  /// A supergrid without nodes has no columns and no rows.
  struct Supergrid {
    std::uint32_t columns = 0, rows = 0;
    double step_x = 0, step_y = 0;    ///< between nodes, in the units of the file's CRS
    double first_x = 0, first_y = 0;  ///< of the south-west node from the south-west corner of its cell
    std::size_t first = 0;            ///< its south-west node among `heights`; then row by row
  };
  std::size_t columns = 0, rows = 0;  ///< of the overview
  std::vector<Supergrid> supergrids;  ///< row by row
  std::vector<float> heights;         ///< of nodes; NaN: no data

  const Supergrid& at(std::size_t row, std::size_t column) const {
    return supergrids[row * columns + column];
  }
};

/// Whether a BAG has refinements; GDAL says so only where it likes them.
bool has_bag_refinements(const std::filesystem::path& file);

/// Reads all refinements of a BAG that format_of() and companions_of() have let pass. Throws InputError for a
/// file whose tables are not there, contradict each other, or say more than limits::cells.
BagRefinements read_bag_refinements(const std::filesystem::path& file);

/// The command that writes one resolution of a BAG of variable resolution, between backticks. Of GDAL's cells
/// those without a node have no data. So the resolution is the finest at which each cell has a node, by the
/// table of supergrids, where `cell_x` and `cell_y` are the sides of a cell of the overview. METRES is for
/// the user to fill in where the table cannot be read.
std::string advised_resampling(const std::filesystem::path& file, double cell_x, double cell_y);

}  // namespace tubefoot
