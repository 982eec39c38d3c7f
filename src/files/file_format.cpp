// SPDX-License-Identifier: GPL-3.0-or-later

// Determines the format of a file from its first 4096 bytes: binary signatures first, then words of text
// formats. It rejects a file whose bytes match two formats.

#include "files/file_format.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>

#include "files/input_registry.hpp"

namespace tubefoot {
namespace {

// GDAL searches the root element of a virtual raster in the first 1024 bytes. HDF5 searches its signature
// at the offsets 0, 512, 1024 and so on. Here only the offset 0 counts as HDF5, and a signature at another
// offset is not recognised.
constexpr std::size_t looked_at = 4096;
using namespace std::string_view_literals;

std::string lower(std::string_view text) {
  std::string result(text);
  std::ranges::transform(result, result.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return result;
}

/// Returns whether the bytes begin with a 3DS chunk. Its length exceeds that of the header of its first
/// sub-chunk, which is one of two kinds.
bool is_3ds(std::string_view head) {
  if (head.size() < 12 || !head.starts_with("MM"sv)) return false;
  const std::string_view first = head.substr(6, 2);
  return first == "\2\0"sv || first == "\x3d\x3d"sv;
}

FileFormat by_signature(std::string_view head, const std::filesystem::path& file) {
  const auto begins = [head](std::string_view with) { return head.starts_with(with); };
  if (begins("II*\0"sv) || begins("MM\0*"sv) || begins("II+\0"sv) || begins("MM\0+"sv))
    return FileFormat::geotiff;
  if (begins("\x89HDF\r\n\x1a\n"sv))
    return lower(file.extension().string()) == ".bag" ? FileFormat::bag : FileFormat::netcdf4;
  if (begins("CDF\1"sv) || begins("CDF\2"sv) || begins("CDF\5"sv)) return FileFormat::netcdf_classic;
  if (begins("\x89PNG\r\n\x1a\n"sv)) return FileFormat::png;
  if (begins("SQLite format 3\0"sv)) return FileFormat::geopackage;
  if (begins("\0\0\x27\x0a"sv)) return FileFormat::shapefile;
  if (begins("glTF"sv)) return FileFormat::gltf_binary;
  if (begins("Kaydara FBX Binary  \0"sv)) return FileFormat::fbx;
  if (is_3ds(head)) return FileFormat::studio_3ds;
  return FileFormat::other;
}

FileFormat by_words(const std::string& head, const std::filesystem::path& file) {
  const std::size_t first = head.find_first_not_of(" \t\r\n");
  if (first == head.npos) return FileFormat::other;
  const std::string_view text = std::string_view(head).substr(first);
  constexpr std::array keys{"ncols"sv,     "nrows"sv, "xllcorner"sv, "yllcorner"sv, "xllcenter"sv,
                            "yllcenter"sv, "dx"sv,    "dy"sv,        "cellsize"sv};
  for (const std::string_view key : keys)
    if (text.starts_with(key) && text.size() > key.size() && std::isspace(text[key.size()]))
      return FileFormat::ascii_grid;
  if (text.starts_with('{') || text.starts_with("\xef\xbb\xbf{"))
    return lower(file.extension().string()) == ".gltf" ? FileFormat::gltf : FileFormat::geojson;
  if (text.starts_with("; fbx") || text.find("fbxheaderextension:") != text.npos) return FileFormat::fbx;
  // Comments and declarations may precede the root element.
  if ((text.starts_with('<') || text.starts_with("\xef\xbb\xbf<")) && text.find("<collada") != text.npos)
    return FileFormat::collada;
  return FileFormat::other;
}

}  // namespace

FileFormat format_of(const std::filesystem::path& file) {
  const std::string head = InputFile(file).head(looked_at), words = lower(head);
  FileFormat format = by_signature(head, file);
  if (format == FileFormat::other) format = by_words(words, file);
  if (words.find("<vrtdataset") == words.npos) return format;
  if (format != FileFormat::other)
    throw InputError({file.string(), 0, 0},
                     "begins like two formats at once, one of them a virtual raster (VRT): write it again");
  return FileFormat::vrt;
}

std::string_view name_of(FileFormat format) {
  switch (format) {
    case FileFormat::geotiff:
      return "GeoTIFF";
    case FileFormat::bag:
      return "BAG";
    case FileFormat::netcdf4:
    case FileFormat::netcdf_classic:
      return "netCDF";
    case FileFormat::ascii_grid:
      return "ESRI ASCII grid";
    case FileFormat::png:
      return "PNG";
    case FileFormat::vrt:
      return "VRT";
    case FileFormat::geopackage:
      return "GeoPackage";
    case FileFormat::geojson:
      return "GeoJSON";
    case FileFormat::shapefile:
      return "Shapefile";
    case FileFormat::collada:
      return "COLLADA";
    case FileFormat::gltf:
    case FileFormat::gltf_binary:
      return "glTF";
    case FileFormat::studio_3ds:
      return "3DS";
    case FileFormat::fbx:
      return "FBX";
    case FileFormat::other:
      break;
  }
  return "another format";
}

const char* gdal_driver_of(FileFormat format) {
  switch (format) {
    case FileFormat::geotiff:
      return "GTiff";
    case FileFormat::bag:
      return "BAG";
    case FileFormat::netcdf4:
    case FileFormat::netcdf_classic:
      return "netCDF";
    case FileFormat::ascii_grid:
      return "AAIGrid";
    case FileFormat::png:
      return "PNG";
    case FileFormat::vrt:
      return "VRT";
    case FileFormat::geopackage:
      return "GPKG";
    case FileFormat::geojson:
      return "GeoJSON";
    case FileFormat::shapefile:
      return "ESRI Shapefile";
    case FileFormat::collada:
    case FileFormat::gltf:
    case FileFormat::gltf_binary:
    case FileFormat::studio_3ds:
    case FileFormat::fbx:
    case FileFormat::other:
      break;
  }
  return nullptr;
}

bool is_model(FileFormat format) {
  return format == FileFormat::collada || format == FileFormat::gltf || format == FileFormat::gltf_binary ||
         format == FileFormat::studio_3ds || format == FileFormat::fbx;
}

bool is_hdf5(FileFormat format) { return format == FileFormat::bag || format == FileFormat::netcdf4; }

}  // namespace tubefoot
