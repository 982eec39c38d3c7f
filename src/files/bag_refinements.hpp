// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <limits>
#include <string>
#include <vector>

namespace tubefoot {

/// Refinements of a Bathymetric Attributed Grid (BAG) of variable resolution, in addition to its overview.
/// Each cell of the overview has a grid of nodes, which is called a supergrid as in GDAL. Rows of cells and
/// nodes count from the south, columns from the west. (Format Specification Document of BAG 2.0, "Variable
/// Resolution")
struct BagRefinements {
  /// A supergrid without nodes has no columns and no rows.
  struct Supergrid {
    std::uint32_t columns = 0, rows = 0;
    double step_x = 0, step_y = 0;  ///< distance of nodes, in the units of the file's CRS
    double first_x = 0,
           first_y = 0;     ///< offset of the south-west node from the south-west corner of the cell
    std::size_t first = 0;  ///< index of the south-west node in `heights`; the other nodes follow row by row
  };
  std::size_t columns = 0, rows = 0;  ///< size of the overview
  std::vector<Supergrid> supergrids;  ///< in row order
  std::vector<float> heights;         ///< heights of nodes; NaN where there is no data

  const Supergrid& at(std::size_t row, std::size_t column) const {
    return supergrids[row * columns + column];
  }
};

/// Returns whether a BAG has refinements. GDAL reports refinements only if it accepts them.
bool has_bag_refinements(const std::filesystem::path& file);

/// Reads all refinements of a BAG that format_of() and companions_of() accepted. Throws InputError if
/// tables are missing, contradict each other, or have more than limits::cells entries.
BagRefinements read_bag_refinements(const std::filesystem::path& file);

/// Returns the command that writes one resolution of a BAG of variable resolution, between backticks. GDAL
/// gives no data to cells without a node. The resolution is therefore the finest at which each cell has a
/// node, by the table of supergrids. `cell_x` and `cell_y` are the sides of a cell of the overview. If the
/// table cannot be read, the command has the word METRES for the user to replace.
std::string advised_resampling(const std::filesystem::path& file, double cell_x, double cell_y);

}  // namespace tubefoot
