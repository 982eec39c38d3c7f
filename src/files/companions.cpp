// SPDX-License-Identifier: GPL-3.0-or-later

// Finds the companions of an input file, which its readers open as well. Examples are world files,
// projections, masks, parts of a Shapefile and sources of virtual rasters. It limits the depth, the number
// and the size of these files.

#include "files/companions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <set>
#include <string>
#include <string_view>

#include "files/absolute_path.hpp"
#include "files/file_format.hpp"
#include "files/geojson_file.hpp"
#include "files/geopackage_file.hpp"
#include "files/gltf_file.hpp"
#include "files/hdf5_file.hpp"
#include "files/input_error.hpp"
#include "files/library_settings.hpp"
#include "files/limits.hpp"
#include "files/netcdf_size.hpp"
#include "files/tiff_file.hpp"
#include "files/vrt_file.hpp"

namespace tubefoot {

namespace fs = std::filesystem;

namespace {

constexpr int deepest_vrt = 8;
/// Largest size in bytes of a file that georeferences another file or describes its contents.
constexpr std::uintmax_t most_words = 65536;
/// Largest number of rasters that one virtual raster refers to. A raster counts once per reference.
constexpr std::size_t most_sources = 50'000;

class Companions {
 public:
  using Admit = std::function<void(const fs::path&)>;
  Companions(const fs::path& file, const Admit& admit) : file_(plain_name(file)), admit_(admit) {}

  std::vector<fs::path> find() {
    add_of(file_, 0);
    return std::move(found_);
  }

 private:
  /// Adds the companions of `file`. Returns the number of rasters that it refers to.
  std::size_t add_of(const fs::path& file, int depth) {
    if (const auto known = requested_.find(file); known != requested_.end()) return known->second;
    const std::size_t rasters = add_what_goes_with(file, depth);
    requested_[file] = rasters;
    return rasters;
  }

  std::size_t add_what_goes_with(const fs::path& file, int depth) {
    const FileFormat format = format_of(file);
    const SourcePlace place{file.string(), 0, 0};
    switch (format) {
      case FileFormat::other:
      case FileFormat::collada:
      case FileFormat::studio_3ds:
      case FileFormat::fbx:
        return 1;
      case FileFormat::geojson:
        refuse_many_attributes(file);
        return 1;
      case FileFormat::gltf:
      case FileFormat::gltf_binary:
        for (const GltfBuffer& buffer : gltf_buffers(file)) add(buffer.file);
        return 1;
      case FileFormat::geopackage:
        refuse_geopackage_surprises(file);
        return 1;
      case FileFormat::shapefile:
        for (const char* extension : {".shx", ".dbf", ".prj", ".cpg"}) add_with_extension(file, extension);
        return 1;
      case FileFormat::bag:
      case FileFormat::netcdf4:
        refuse_hdf5_references(file);
        break;
      case FileFormat::netcdf_classic:
        refuse_short_netcdf(place);
        break;
      case FileFormat::ascii_grid:
        add_with_extension(file, ".prj");
        break;
      case FileFormat::geotiff:
        refuse_long_tiff(file);
        add_world_files(file);
        break;
      case FileFormat::png:
        add_world_files(file);
        break;
      case FileFormat::vrt:
        return add_sources(file, depth);
    }
    add(fs::path(file) += ".aux.xml", 64 * most_words);
    const fs::path mask = fs::path(file) += ".msk";
    if (add(mask) && format_of(mask) != FileFormat::geotiff)
      throw InputError({mask.string(), 0, 0},
                       "is not a GeoTIFF, but its name is that of a raster's mask: move it away");
    return 1;
  }

  std::size_t add_sources(const fs::path& vrt, int depth) {
    const auto fail = [&](const std::string& what) { throw InputError({vrt.string(), 0, 0}, what); };
    if (depth == deepest_vrt)
      fail(fmt::format("is a virtual raster nested in {} others: name its sources directly", deepest_vrt));
    std::size_t rasters = 0;
    for (const fs::path& source : vrt_sources(vrt)) {
      std::error_code ignored;
      if (!fs::is_regular_file(source, ignored))
        fail(fmt::format("is a virtual raster of '{}', which is not a file", source.string()));
      add(source);
      switch (format_of(source)) {
        case FileFormat::other:
        case FileFormat::geopackage:
        case FileFormat::geojson:
        case FileFormat::shapefile:
        case FileFormat::collada:
        case FileFormat::gltf:
        case FileFormat::gltf_binary:
        case FileFormat::studio_3ds:
        case FileFormat::fbx:
          fail(fmt::format(
              "is a virtual raster of '{}', which is not a GeoTIFF, BAG, ESRI ASCII grid, netCDF, PNG or VRT",
              source.string()));
        default:
          break;
      }
      rasters += add_of(source, depth + 1);
      if (rasters > most_sources)
        fail(fmt::format("is a virtual raster of more than {} rasters: use fewer", most_sources));
    }
    return std::max<std::size_t>(rasters, 1);
  }

  /// Adds world files with the names that GDAL uses. Their extensions are the first and the last letter of
  /// the file's extension and a w, the whole extension and a w, and wld.
  void add_world_files(const fs::path& file) {
    const std::string extension = file.extension().string();
    if (extension.size() > 2) {
      add_with_extension(file, std::string{'.', extension[1], extension.back(), 'w'});
      add_with_extension(file, extension + 'w');
    }
    add_with_extension(file, ".wld");
  }

  /// Adds files with `extension` instead of the file's own, in lower case and in upper case.
  void add_with_extension(const fs::path& file, const std::string& extension) {
    std::string small = extension, large = extension;
    std::ranges::transform(small, small.begin(), [](unsigned char c) { return char(std::tolower(c)); });
    std::ranges::transform(large, large.begin(), [](unsigned char c) { return char(std::toupper(c)); });
    // The parts of a Shapefile hold values; the other companions are short texts.
    const std::uintmax_t most = small == ".dbf" || small == ".shx" ? limits::named_file_bytes : most_words;
    add(fs::path(file).replace_extension(small), most);
    add(fs::path(file).replace_extension(large), most);
  }

  /// Adds a file if it exists. Throws for a file that is not regular, because its reader would open it.
  bool add(const fs::path& path, std::uintmax_t most_bytes = limits::named_file_bytes) {
    std::error_code ignored;
    const fs::file_status status = fs::status(path, ignored);
    if (!fs::exists(status) || status.type() == fs::file_type::directory) return false;
    if (status.type() != fs::file_type::regular)
      throw InputError(
          {path.string(), 0, 0},
          fmt::format("is a special file, but its name is that of a companion file of '{}': move it away",
                      file_.filename().string()));
    if (path == file_ || !known_.insert(path).second) return true;
    if (admit_) admit_(path);
    if (fs::file_size(path, ignored) > most_bytes)
      throw InputError(
          {path.string(), 0, 0},
          fmt::format(
              "has more than {} bytes, but its name is that of a companion file of '{}': move it away",
              most_bytes, file_.filename().string()));
    found_.push_back(path);
    return true;
  }

  fs::path file_;
  const Admit& admit_;
  std::vector<fs::path> found_;
  std::set<fs::path> known_;
  std::map<fs::path, std::size_t> requested_;  ///< number of rasters, by virtual raster
};

}  // namespace

std::vector<fs::path> companions_of(const fs::path& file, const std::function<void(const fs::path&)>& admit) {
  return Companions(file, admit).find();
}

std::optional<fs::path> place_outside(const fs::path& folder, const fs::path& file) {
  std::error_code error;
  const fs::path inside = fs::weakly_canonical(absolute_path(folder.empty() ? "." : folder), error);
  const fs::path real = fs::weakly_canonical(absolute_path(file), error);
  if (std::ranges::mismatch(inside, real).in1 == inside.end()) return std::nullopt;
  return real;
}

}  // namespace tubefoot
