// SPDX-License-Identifier: GPL-3.0-or-later

// Reads a material map from the classes of a raster: one region per material, with borders along the edges
// of cells. The borders are transformed into the local frame.

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "files/gdal_input.hpp"
#include "files/limits.hpp"
#include "geometry/steps/stop.hpp"
#include "scene/surfaces/material_map_gdal.hpp"
#include "scene/surfaces/material_map_sources.hpp"

namespace tubefoot {
namespace {

/// Regions of a raster's cells, row by row from the north-west; kNone for the default material.
struct Classes {
  static constexpr std::uint16_t kNone = 0xffff;
  int columns = 0, rows = 0;
  std::vector<std::uint16_t> region;

  std::uint16_t at(int column, int row) const {
    if (column < 0 || row < 0 || column >= columns || row >= rows) return kNone;
    return region[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                  static_cast<std::size_t>(column)];
  }
};

Classes read_classes(const GdalInput& input, const RasterMaterialMap& map, const MaterialMapSetting& setting,
                     const SourcePlace& place) {
  GDALDataset& dataset = input.dataset();
  Classes classes{dataset.GetRasterXSize(), dataset.GetRasterYSize(), {}};
  if (dataset.GetRasterCount() == 0) throw InputError(place, input.no_single_raster());
  input.refuse_colours("classes", false);
  if (static_cast<double>(classes.columns) * classes.rows > limits::cells)
    throw InputError(
        place, fmt::format("{} x {} cells exceed the limit of {:.3g}: cut the raster to the terrain with {}",
                           classes.columns, classes.rows, limits::cells,
                           input.advised("gdal_translate -projwin WEST NORTH EAST SOUTH")));
  std::map<double, std::uint16_t> region_of;
  for (const MaterialClass& c : map.classes) {
    const std::uint16_t material = material_named(c.material, setting.materials, c.place, "");
    region_of[std::stod(c.value)] = material == setting.default_material ? Classes::kNone : material;
  }
  GDALRasterBand& band = *dataset.GetRasterBand(1);
  const auto columns = static_cast<std::size_t>(classes.columns);
  std::vector<double> values(columns);
  std::vector<unsigned char> has_data(columns);
  std::set<double> unknown;
  for (int row = 0; row < classes.rows; ++row) {
    input.read_row(band, row, 0, classes.columns, GDT_Float64, values.data());
    input.read_row(*band.GetMaskBand(), row, 0, classes.columns, GDT_Byte, has_data.data());
    for (std::size_t i = 0; i < columns; ++i) {
      std::uint16_t region = Classes::kNone;
      if (has_data[i] != 0 && !std::isnan(values[i])) {
        const auto found = region_of.find(values[i]);
        if (found != region_of.end())
          region = found->second;
        else if (unknown.size() < 31)
          unknown.insert(values[i]);
      }
      classes.region.push_back(region);
    }
  }
  if (!unknown.empty()) {
    const bool more = unknown.size() > 30;
    if (more) unknown.erase(std::prev(unknown.end()));
    throw InputError(place, fmt::format("has classes without a material: {}{}; add each of them to 'classes'",
                                        fmt::join(unknown, ", "), more ? " and others" : ""));
  }
  return classes;
}

/// A line from the north-west corner of one cell to that of another, with the regions on its sides.
struct Run {
  int column, row, to_column, to_row;
  std::uint16_t region, other;
};

/// Returns the edges of cells between regions. Consecutive edges between the same two regions form one long
/// run. No other run ends between the ends of a run.
std::vector<Run> runs_between(const Classes& classes, bool merge, const SourcePlace& place) {
  std::vector<Run> runs;
  const auto follow = [&](int lines, int steps, auto beside, auto make) {
    for (int line = 0; line <= lines; ++line) {
      int begin = 0;
      for (int step = 0; step <= steps; ++step) {
        const auto here = beside(line, begin);
        if (step < steps && beside(line, step) == here && (merge || step == begin)) continue;
        if (here.first != here.second) runs.push_back(make(line, begin, step, here));
        begin = step;
      }
      check_border_count(runs.size(), place);
    }
  };
  using Pair = std::pair<std::uint16_t, std::uint16_t>;
  follow(
      classes.columns, classes.rows,
      [&](int column, int row) { return Pair(classes.at(column - 1, row), classes.at(column, row)); },
      [](int column, int from, int to, Pair p) { return Run{column, from, column, to, p.first, p.second}; });
  follow(
      classes.rows, classes.columns,
      [&](int row, int column) { return Pair(classes.at(column, row - 1), classes.at(column, row)); },
      [](int row, int from, int to, Pair p) { return Run{from, row, to, row, p.first, p.second}; });
  return runs;
}

/// Positions of the corners of cells in the frame.
class Corners {
 public:
  Corners(const GdalInput& input, const RasterMaterialMap& map, const MaterialMapSetting& setting,
          const SourcePlace& place)
      : setting_(setting), place_(place) {
    GDALDataset& dataset = input.dataset();
    const int rows = dataset.GetRasterYSize();
    if (map.origin_m && map.cell_m) {
      local_ = true;
      if (const auto unknown = input.unknown_row_order()) throw InputError(place, *unknown);
      affine_ = {(*map.origin_m)[0], *map.cell_m, 0, (*map.origin_m)[1] + rows * *map.cell_m, 0,
                 -*map.cell_m};
      return;
    }
    crs_ = input.crs();
    const auto transform = input.geotransform();
    if (!transform) throw InputError(place, input.no_geotransform("give 'origin_m' and 'cell_m'"));
    affine_ = *transform;
    if (affine_[2] != 0 || affine_[4] != 0 || !(affine_[1] > 0) || !(affine_[5] < 0))
      throw InputError(place, fmt::format("is not north-up: turn it with {}",
                                          input.advised(fmt::format("gdalwarp {}", warp_classes))));
  }

  glm::dvec3 in_file(int column, int row) const {
    return {affine_[0] + column * affine_[1], affine_[3] + row * affine_[5],
            setting_.frame.origin_height_m() + (setting_.lo_m.z + setting_.hi_m.z) / 2};
  }
  void carry(std::span<glm::dvec3> points) const {
    if (!local_)
      carry_map_points(points, crs_, setting_.frame, place_,
                       "give 'origin_m' and 'cell_m' in metres in the local frame, or write a copy with a "
                       "coordinate reference "
                       "system by `gdal_translate -a_srs EPSG:... IN OUT`");
  }
  /// Returns whether straight lines along the cells stay straight in the frame to a micrometre.
  bool stay_straight(int columns, int rows) const {
    std::vector<glm::dvec3> p;
    for (int j = 0; j <= 2; ++j)
      for (int i = 0; i <= 2; ++i) {
        p.push_back(in_file(0, 0));
        p.back().x += columns * affine_[1] * i / 2, p.back().y += rows * affine_[5] * j / 2;
      }
    carry(p);
    for (const auto& [a, m, b] :
         {std::array{0, 1, 2}, {3, 4, 5}, {6, 7, 8}, {0, 3, 6}, {1, 4, 7}, {2, 5, 8}}) {
      const glm::dvec2 bend =
          glm::dvec2(p[static_cast<std::size_t>(a)] + p[static_cast<std::size_t>(b)]) * 0.5 -
          glm::dvec2(p[static_cast<std::size_t>(m)]);
      if (std::hypot(bend.x, bend.y) > 1e-6) return false;
    }
    return true;
  }

 private:
  const MaterialMapSetting& setting_;
  const SourcePlace& place_;
  bool local_ = false;
  std::string crs_;
  std::array<double, 6> affine_{};
};

}  // namespace

MaterialMap raster_material_map(const RasterMaterialMap& map, const MaterialMapSetting& setting) {
  const SourcePlace place{map.file.string(), 0, 0};
  const GdalInput input(map.file, {FileFormat::geotiff, FileFormat::ascii_grid, FileFormat::netcdf4,
                                   FileFormat::netcdf_classic, FileFormat::bag, FileFormat::png});
  const Corners corners(input, map, setting, place);
  const Classes classes = read_classes(input, map, setting, place);
  const std::vector<Run> runs =
      runs_between(classes, corners.stay_straight(classes.columns, classes.rows), place);
  std::vector<glm::dvec3> ends;
  ends.reserve(2 * runs.size());
  for (const Run& run : runs) {
    ends.push_back(corners.in_file(run.column, run.row));
    ends.push_back(corners.in_file(run.to_column, run.to_row));
  }
  corners.carry(ends);
  std::vector<MaterialBorder> borders;
  borders.reserve(runs.size());
  for (std::size_t k = 0; k < runs.size(); ++k)
    borders.push_back({ends[2 * k], ends[2 * k + 1], std::min(runs[k].region, runs[k].other),
                       std::max(runs[k].region, runs[k].other)});
  for (MaterialBorder& border : borders)
    if (border.other_region == Classes::kNone) border.other_region = MaterialBorder::none;
  std::vector<std::uint16_t> material_of_region(setting.materials.size());
  for (std::size_t m = 0; m < material_of_region.size(); ++m)
    material_of_region[m] = static_cast<std::uint16_t>(m);
  return {std::move(borders), std::move(material_of_region), setting.default_material};
}

}  // namespace tubefoot
