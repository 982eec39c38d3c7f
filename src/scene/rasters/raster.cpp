// SPDX-License-Identifier: GPL-3.0-or-later

// Converts a raster of heights to facets between the centres of its cells, or between the nodes of a BAG of
// variable resolution.

#include "scene/rasters/raster.hpp"

#include <fmt/core.h>

#include <glm/common.hpp>

#include "files/limits.hpp"
#include "files/memory_at_hand.hpp"
#include "scene/rasters/raster_reader.hpp"
#include "scene/rasters/variable_grid.hpp"

namespace tubefoot {

namespace {

void require_cells(const RasterReader& reader, double cells, const std::string& what,
                   const std::string& remedy) {
  if (cells > limits::cells)
    reader.file().fail(fmt::format("{} exceed the limit of {:.3g}: {}", what, limits::cells, remedy));
  require_memory(2 * bytes_a_facet * cells, reader.file().place(), "facets between " + what, remedy);
}

/// Returns the facets between the centres of the cells of one grid.
ComponentMesh facets_of_grid(RasterReader& reader) {
  const RasterWindow& window = reader.window();
  require_cells(reader, window.cells(),
                fmt::format("{} x {} cells", window.kept_columns(), window.kept_rows()),
                "give a window or decimate, or load = \"tiles\"");
  ComponentMesh mesh;
  const auto columns = static_cast<std::size_t>(window.kept_columns());
  std::vector<std::uint32_t> north(columns), south(columns);
  const auto add = [&mesh](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    mesh.triangles.push_back({a, b, c});
  };
  for (int row = 0; row < window.kept_rows(); ++row) {
    reader.read_row(row, 0, window.kept_columns(), mesh.points_m, south.data());
    for (std::size_t k = 0; row > 0 && k + 1 < columns; ++k)
      mesh.hole_cells += join_centres(north[k], north[k + 1], south[k], south[k + 1], add);
    north.swap(south);
  }
  return mesh;
}

/// Returns the facets between all nodes of the supergrids in the window, or those at one resolution.
ComponentMesh facets_of_supergrids(const RasterReader& reader, double resolution_m) {
  const RasterFile& file = reader.file();
  if (resolution_m > 0 && reader.is_in_degrees())
    file.fail("is in degrees, but resolution_m is in metres: omit resolution_m");
  const BagRefinements refinements = read_bag_refinements(file.place().file);
  if (refinements.columns != static_cast<std::size_t>(file.columns()) ||
      refinements.rows != static_cast<std::size_t>(file.rows()))
    file.fail(fmt::format("has {} x {} supergrids, but its overview has {} x {} cells", refinements.columns,
                          refinements.rows, file.columns(), file.rows()));
  const RasterWindow& window = reader.window();
  const auto& g = reader.geotransform();
  const VariableGrid grid{refinements,
                          g[0],
                          g[3] + file.rows() * g[5],
                          g[1],
                          -g[5],
                          static_cast<std::size_t>(window.column),
                          static_cast<std::size_t>(file.rows() - window.row - window.rows),
                          static_cast<std::size_t>(window.columns),
                          static_cast<std::size_t>(window.rows)};
  double nodes = 0;
  for (std::size_t row = 0; row < grid.rows; ++row)
    for (std::size_t column = 0; column < grid.columns; ++column) {
      const auto& supergrid = refinements.at(grid.row + row, grid.column + column);
      nodes += static_cast<double>(supergrid.columns) * supergrid.rows;
    }
  const std::string remedy = fmt::format("give a window, or resample it to one resolution with {}",
                                         advised_resampling(file.place().file, grid.cell_x, grid.cell_y));
  require_cells(reader, nodes, fmt::format("{} nodes", nodes), remedy);
  ComponentMesh mesh = join_supergrids(grid, file.place());
  if (resolution_m > 0) {
    const double step = resolution_m / reader.metres_per_unit();
    require_cells(reader,
                  static_cast<double>(grid.columns) * grid.cell_x / step * static_cast<double>(grid.rows) *
                      grid.cell_y / step,
                  fmt::format("cells of {:g} m", resolution_m), "choose a larger resolution_m, or a window");
    mesh = resampled(mesh, grid, step, file.place());
  }
  for (glm::dvec3& point : mesh.points_m) point.z = reader.height_m(point.z);
  return mesh;
}

}  // namespace

ComponentMesh read_raster(const RasterTerrain& terrain, std::optional<LocalFrame>& frame) {
  RasterReader reader(terrain);
  std::vector<std::string> warnings = reader.settle(frame);
  ComponentMesh mesh = reader.file().has_variable_resolution()
                           ? facets_of_supergrids(reader, terrain.resolution_m)
                           : facets_of_grid(reader);
  mesh.warnings = std::move(warnings);
  drop_unused_points(mesh);
  if (mesh.triangles.empty()) {
    throw InputError(
        reader.file().place(),
        "does not contain three neighbouring cells with data in the window, so no facets can be formed: "
        "check the window and the nodata value");
  }
  glm::dvec3 lo = mesh.points_m.front(), hi = lo;
  for (const glm::dvec3& point : mesh.points_m) lo = glm::min(lo, point), hi = glm::max(hi, point);
  for (std::string& text : reader.odd_extent(lo, hi)) mesh.warnings.push_back(std::move(text));
  reader.carry(mesh.points_m, *frame);
  for (std::string& text : reader.warnings()) mesh.warnings.push_back(std::move(text));
  return mesh;
}

}  // namespace tubefoot
