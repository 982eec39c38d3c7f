// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "footprints/footprint_table.hpp"

namespace tubefoot {

/// A file of footprints, written table by table (docs/footprints.md). Memory holds at most one table. Equal
/// tables give equal bytes. A file that was not closed is removed.
class FootprintFile {
 public:
  virtual ~FootprintFile() = default;
  /// Throws std::runtime_error if writing fails, as does close(), which completes the file.
  virtual void add(const FootprintTable& table) = 0;
  virtual void close() = 0;
};

/// Origin of the tables, which a file states in addition to the tables.
struct FootprintSource {
  const Scene& scene;
  std::string sensor;
};

using FootprintFileMaker = std::unique_ptr<FootprintFile> (*)(const std::filesystem::path& file,
                                                              const FootprintSource& source);
/// Returns the format for the extension of a file. Throws UsageError for an unknown extension.
FootprintFileMaker footprint_file_maker(const std::filesystem::path& file);

/// GeoPackage with MULTIPOLYGON Z. Coordinates are those of the scene's map if the scene is georeferenced
/// (LocalFrame::map), otherwise metres in the local frame.
std::unique_ptr<FootprintFile> geopackage_file(const std::filesystem::path&, const FootprintSource&);
/// GeoJSON: longitude and latitude (RFC 7946) if the scene is georeferenced, otherwise metres in the local
/// frame.
std::unique_ptr<FootprintFile> geojson_file(const std::filesystem::path&, const FootprintSource&);
/// CSV with WKT, in the coordinates of geopackage_file().
std::unique_ptr<FootprintFile> csv_file(const std::filesystem::path&, const FootprintSource&);
/// VTK XML PolyData with one cell per piece, in the local frame. The formats below use the local frame,
/// too.
std::unique_ptr<FootprintFile> vtp_file(const std::filesystem::path&, const FootprintSource&);
/// Wavefront OBJ with one face per piece, named materials and groups, and the columns as comments.
std::unique_ptr<FootprintFile> obj_file(const std::filesystem::path&, const FootprintSource&);
/// Binary PLY with one face per piece and the columns as properties.
std::unique_ptr<FootprintFile> ply_file(const std::filesystem::path&, const FootprintSource&);
/// netCDF-4 with polygons and contiguous ragged arrays as the CF conventions define them.
std::unique_ptr<FootprintFile> netcdf_footprint_file(const std::filesystem::path&, const FootprintSource&);

}  // namespace tubefoot
