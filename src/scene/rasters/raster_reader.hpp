// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "scene/description/terrain_description.hpp"
#include "scene/rasters/georeference.hpp"
#include "scene/rasters/raster_file.hpp"

// Functions for reading a raster completely (raster.hpp) and by tiles (terrain_tiles.hpp).
namespace tubefoot {

/// The part of a raster that a terrain uses: every step-th row and column of a window. The used cells count
/// from its north-west corner.
struct RasterWindow {
  int column = 0, row = 0, columns = 0, rows = 0;  ///< in the file
  int step = 1;
  int kept_columns() const { return (columns + step - 1) / step; }
  int kept_rows() const { return (rows + step - 1) / step; }
  double cells() const { return static_cast<double>(kept_columns()) * kept_rows(); }
};

/// Reads the centres of cells as points in the raster's CRS. Degrees stay degrees until carry() transforms
/// the points into the scene's frame.
class RasterReader {
 public:
  /// The number of a cell without data.
  static constexpr std::uint32_t hole = std::numeric_limits<std::uint32_t>::max();

  /// Throws InputError for a file that is not a raster of heights, and for a window outside of it.
  explicit RasterReader(const RasterTerrain& terrain);

  const RasterFile& file() const { return file_; }
  /// Returns the geotransform of the file.
  const std::array<double, 6>& geotransform() const { return geotransform_; }
  /// Converts a value of the band to metres upwards.
  double height_m(double value) const { return up_ * metres_(value); }
  bool is_in_degrees() const { return !crs_.empty() && is_geographic(crs_, file_.place()); }
  /// Returns the unit of a projected CRS; 1 without one.
  double metres_per_unit() const;
  const RasterWindow& window() const { return window_; }

  /// Determines the frame of a scene without one, or checks that the raster has a position in it. Returns
  /// warnings for the user. Throws InputError.
  std::vector<std::string> settle(std::optional<LocalFrame>& frame) const;
  /// Transforms points from the raster's CRS into the frame, in place.
  void carry(std::span<glm::dvec3> points, const LocalFrame& frame) const;
  /// Returns warnings about the extent of the points. Throws InputError for a raster without CRS whose
  /// extent in metres is only plausible in degrees.
  std::vector<std::string> odd_extent(glm::dvec3 lo, glm::dvec3 hi) const;
  /// Returns the warnings, including those of GDAL.
  std::vector<std::string> warnings() const;

  /// Appends the points of `count` used cells of a used row, from a used column on. `numbers` receives the
  /// index of the point of each cell, or hole.
  void read_row(int row, int column, int count, std::vector<glm::dvec3>& points, std::uint32_t* numbers);

 private:
  RasterFile file_;
  RasterWindow window_;
  std::array<double, 6> geotransform_;
  RasterFile::Metres metres_;
  double up_;
  std::string crs_;
  std::vector<double> values_;
  std::vector<unsigned char> has_data_;
};

/// Adds two triangles if all four centres have data, and one if three have. Returns whether a centre has no
/// data.
template <class Add>
bool join_centres(std::uint32_t nw, std::uint32_t ne, std::uint32_t sw, std::uint32_t se, const Add& add) {
  constexpr std::uint32_t hole = RasterReader::hole;
  const auto take = [&add](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    if (a != hole && b != hole && c != hole) add(a, b, c);
  };
  if (nw == hole || se == hole) {
    take(sw, se, ne);
    take(sw, ne, nw);
  } else {
    take(sw, se, nw);
    take(se, ne, nw);
  }
  return nw == hole || ne == hole || sw == hole || se == hole;
}

}  // namespace tubefoot
