// SPDX-License-Identifier: GPL-3.0-or-later

// Loads the micro-texture of materials: layers of Perlin noise, and maps from rasters that are repeated
// from the origin or lie at their georeferenced position.

#include "scene/surfaces/reflectivity.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>

#include "engine/scattering/layered_reflectivity.hpp"
#include "engine/scattering/map_reflectivity.hpp"
#include "engine/scattering/perlin_reflectivity.hpp"
#include "files/gdal_input.hpp"
#include "files/limits.hpp"

namespace tubefoot {
namespace {

class MapReader {
 public:
  MapReader(const MapReflectivityKeys& keys, const LocalFrame& frame)
      : keys_(keys),
        frame_(frame),
        input_(keys.file, {FileFormat::geotiff, FileFormat::ascii_grid, FileFormat::bag, FileFormat::netcdf4,
                           FileFormat::netcdf_classic, FileFormat::png}) {
    if (input_.dataset().GetRasterCount() == 0) fail(input_.no_single_raster());
    input_.refuse_colours("reflectivities");
    columns_ = input_.dataset().GetRasterXSize();
    rows_ = input_.dataset().GetRasterYSize();
    if (double(columns_) * rows_ > limits::cells)
      fail(fmt::format("{} x {} pixels exceed the limit of {:.3g}: shrink the image with {}", columns_, rows_,
                       limits::cells, input_.advised("gdal_translate -r average -outsize 25% 0")));
  }

  std::shared_ptr<const ReflectivityField> read() {
    MapReflectivity::Grid grid{std::size_t(columns_), std::size_t(rows_), values()};
    const MapReflectivity::Placing placing = keys_.tile_m ? tiled() : placed();
    try {
      return std::make_shared<MapReflectivity>(std::move(grid), placing);
    } catch (const std::invalid_argument& error) {
      fail(error.what());
    }
  }

  /// Returns a message for a repeated map whose rows have no coordinates.
  std::optional<std::string> unknown_row_order() const {
    return keys_.tile_m ? input_.unknown_row_order() : std::nullopt;
  }
  const GdalMessages& messages() const { return input_.messages(); }
  const SourcePlace& place() const { return input_.place(); }

 private:
  [[noreturn]] void fail(const std::string& message) const { input_.fail(message); }

  std::vector<float> values() {
    GDALRasterBand& band = *input_.dataset().GetRasterBand(1);
    const double scale = band.GetScale() == 0 ? 1 : band.GetScale(), offset = band.GetOffset();
    std::vector<float> values;
    values.reserve(std::size_t(columns_) * std::size_t(rows_));
    std::vector<double> row(static_cast<std::size_t>(columns_));
    std::vector<unsigned char> has_data(row.size());
    for (int j = 0; j < rows_; ++j) {
      input_.read_row(band, j, 0, columns_, GDT_Float64, row.data());
      input_.read_row(*band.GetMaskBand(), j, 0, columns_, GDT_Byte, has_data.data());
      for (std::size_t i = 0; i < row.size(); ++i) {
        const double value = row[i] * scale + offset;
        values.push_back(has_data[i] == 0 || std::isnan(value) ? std::numeric_limits<float>::quiet_NaN()
                         : keys_.values == "db"                ? float(std::pow(10, value / 10))
                                                               : float(value));
      }
    }
    return values;
  }

  /// Returns the placement with north up and the south-west corner at the frame's origin.
  MapReflectivity::Placing tiled() const {
    const double width = (*keys_.tile_m)[0] / columns_, height = (*keys_.tile_m)[1] / rows_;
    return {{width / 2, (*keys_.tile_m)[1] - height / 2}, {width, 0}, {0, -height}, true};
  }

  MapReflectivity::Placing placed() const {
    const auto transform = input_.geotransform();
    if (!transform) fail(input_.no_geotransform("give 'tile_m'"));
    const std::array<double, 6>& g = *transform;
    const std::string crs = input_.crs();
    const bool with_crs = !crs.empty();
    if (with_crs && !frame_.is_georeferenced())
      fail("has a coordinate reference system, but the scene has none: add [georeference], or give 'tile_m'");
    if (!with_crs && frame_.is_georeferenced())
      fail(
          fmt::format("has no coordinate reference system, but the scene's frame is georeferenced: write a "
                      "copy with one by {}, "
                      "or give 'tile_m'",
                      input_.advised("gdal_translate -a_srs EPSG:...")));
    // Corners, midpoints of edges and the centre, in coordinates of pixel centres.
    const double w = columns_, h = rows_;
    std::vector<glm::dvec3> points;
    for (const double row : {0.0, h / 2, h})
      for (const double column : {0.0, w / 2, w})
        points.emplace_back(g[0] + column * g[1] + row * g[2], g[3] + column * g[4] + row * g[5], 0);
    if (with_crs) frame_.carry(points, crs, place());
    const auto plan = [&](std::size_t k) { return glm::dvec2(points[k]); };
    const glm::dvec2 column = (plan(5) - plan(3)) / w, row = (plan(7) - plan(1)) / h;
    const glm::dvec2 corner = plan(4) - w / 2 * column - h / 2 * row;
    const double pixel = std::min(glm::length(column), glm::length(row));
    for (std::size_t k = 0; k < points.size(); ++k) {
      const glm::dvec2 straight = corner + double(k % 3) * (w / 2) * column + double(k / 3) * (h / 2) * row;
      if (!(glm::length(plan(k) - straight) <= pixel / 2))
        fail(
            fmt::format("deviates by up to {:.3g} m from a parallelogram in the scene's frame, more than "
                        "half a pixel: project it with {}",
                        glm::length(plan(k) - straight),
                        input_.advised(fmt::format("gdalwarp -t_srs EPSG:... {}", warp_heights))));
    }
    return {corner + column / 2.0 + row / 2.0, column, row, false};
  }

  const MapReflectivityKeys& keys_;
  const LocalFrame& frame_;
  GdalInput input_;
  int columns_ = 0, rows_ = 0;
};

}  // namespace

std::shared_ptr<const ReflectivityField> load_reflectivity(const MaterialDescription& material,
                                                           const LocalFrame& frame,
                                                           std::vector<std::string>& warnings) {
  std::vector<std::shared_ptr<const ReflectivityField>> layers;
  bool has_map = false;
  for (const ReflectivityDescription& layer : material.reflectivity) {
    if (const auto* map = std::get_if<MapReflectivityKeys>(&layer.kind)) {
      if (has_map)
        throw InputError(layer.place,
                         fmt::format("material '{}' has a second map of reflectivity: combine the two maps "
                                     "into one, because their product has an unknown mean",
                                     material.name));
      has_map = true;
      MapReader reader(*map, frame);
      layers.push_back(reader.read());
      if (const auto unknown = reader.unknown_row_order())
        warnings.push_back(
            fmt::format("{}: {}; tubefoot assumes that it is the last row", reader.place().file, *unknown));
      for (const std::string& text : reader.messages().warnings())
        warnings.push_back(fmt::format("{}: GDAL: {}", reader.place().file, text));
      continue;
    }
    const auto& keys = std::get<PerlinReflectivityKeys>(layer.kind);
    // The first layer uses the lattice of the seed itself.
    const std::uint64_t seed = keys.seed + 0x9e3779b97f4a7c15u * layers.size();
    layers.push_back(std::make_shared<PerlinReflectivity>(
        PerlinReflectivity::Settings{keys.wavelength_m, keys.octaves, keys.persistence, keys.depth, seed}));
  }
  if (layers.empty()) return nullptr;
  if (layers.size() == 1) return layers.front();
  return std::make_shared<LayeredReflectivity>(std::move(layers));
}

}  // namespace tubefoot
