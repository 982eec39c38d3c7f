// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/raster.hpp"

#include <fmt/core.h>

#include "files/limits.hpp"
#include "files/memory_at_hand.hpp"
#include "scene/raster_reader.hpp"

namespace tubefoot {

ComponentMesh read_raster(const RasterTerrain& terrain, std::optional<LocalFrame>& frame) {
  RasterReader reader(terrain);
  const RasterWindow& window = reader.window();
  if (window.cells() > limits::cells) {
    reader.file().fail(
        fmt::format("{} x {} cells are more than {:.3g}: give a window or decimate, or load = "
                    "\"tiles\"",
                    window.kept_columns(), window.kept_rows(), limits::cells));
  }
  require_memory(2 * bytes_a_facet * window.cells(), reader.file().place(),
                 fmt::format("facets between {} x {} cells", window.kept_columns(), window.kept_rows()),
                 "give a window or decimate, or load = \"tiles\"");
  ComponentMesh mesh;
  mesh.warnings = reader.settle(frame);
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
  reader.carry(mesh.points_m, *frame);
  drop_unused_points(mesh);
  if (mesh.triangles.empty()) {
    throw InputError(
        reader.file().place(),
        "has no three neighbouring cells with data in the window, so it gives no facet: check the "
        "window and the nodata value");
  }
  for (std::string& text : reader.warnings()) mesh.warnings.push_back(std::move(text));
  return mesh;
}

}  // namespace tubefoot
