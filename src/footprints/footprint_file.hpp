// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "footprints/footprint_table.hpp"

namespace tubefoot {

/// A file of footprints, written table by table (docs/footprints.md). No more than a table is held in memory.
/// The bytes are the same for the same tables. What was not closed is taken away.
class FootprintFile {
 public:
  virtual ~FootprintFile() = default;
  /// Throws std::runtime_error where writing fails; so does close(), which completes the file.
  virtual void add(const FootprintTable& table) = 0;
  virtual void close() = 0;
};

/// What a file says besides its tables.
struct FootprintSource {
  const Scene& scene;
  std::string sensor;
};

using FootprintFileMaker = std::unique_ptr<FootprintFile> (*)(const std::filesystem::path& file,
                                                              const FootprintSource& source);
/// The format that the ending of a file asks for; throws UsageError for an unknown one.
FootprintFileMaker footprint_file_maker(const std::filesystem::path& file);

/// GeoPackage: MULTIPOLYGON Z in the scene's map, if it is georeferenced (LocalFrame::map), else in metres
/// of the local frame.
std::unique_ptr<FootprintFile> geopackage_file(const std::filesystem::path&, const FootprintSource&);
/// GeoJSON: longitude and latitude (RFC 7946) if the scene is georeferenced, else metres of the local frame.
std::unique_ptr<FootprintFile> geojson_file(const std::filesystem::path&, const FootprintSource&);
/// CSV with WKT, in the coordinates of geopackage_file().
std::unique_ptr<FootprintFile> csv_file(const std::filesystem::path&, const FootprintSource&);
/// VTK XML PolyData, a cell for each piece, in the local frame; so are all that follow.
std::unique_ptr<FootprintFile> vtp_file(const std::filesystem::path&, const FootprintSource&);
/// Wavefront OBJ, a face for each piece, materials and groups named, columns as comments.
std::unique_ptr<FootprintFile> obj_file(const std::filesystem::path&, const FootprintSource&);
/// PLY, binary, a face for each piece with the columns as properties.
std::unique_ptr<FootprintFile> ply_file(const std::filesystem::path&, const FootprintSource&);
/// netCDF-4 with CF's polygons and contiguous ragged arrays.
std::unique_ptr<FootprintFile> netcdf_footprint_file(const std::filesystem::path&, const FootprintSource&);

}  // namespace tubefoot
