// SPDX-License-Identifier: GPL-3.0-or-later

// Opens raster and vector files with GDAL and checks them before any value is read. It rejects references
// to other files, overlarge blocks and ambiguous coordinate systems. Messages advise a command that repairs
// the file.

#include "files/gdal_input.hpp"

#include <fmt/ranges.h>
#include <ogrsf_frmts.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <functional>
#include <mutex>
#include <vector>

#include "files/advised_command.hpp"
#include "files/bag_refinements.hpp"
#include "files/companions.hpp"
#include "files/grid_words.hpp"
#include "files/input_registry.hpp"
#include "files/library_settings.hpp"
#include "files/limits.hpp"
#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

/// Returns a list for messages: "GeoTIFF, BAG or VRT".
std::string list_of(std::initializer_list<FileFormat> formats) {
  std::vector<std::string_view> names;
  for (const FileFormat format : formats)
    if (std::ranges::find(names, name_of(format)) == names.end()) names.push_back(name_of(format));
  const std::string_view last = names.back();
  names.pop_back();
  return names.empty() ? std::string(last) : fmt::format("{} or {}", fmt::join(names, ", "), last);
}

GDALDatasetUniquePtr opened(const fs::path& file, FileFormat format) {
  const std::array<const char*, 2> drivers{gdal_driver_of(format), nullptr};
  // By default SQLite searches for changes in a file next to the database. These options declare that none
  // exist.
  const std::array<const char*, 3> unlocked{"NOLOCK=YES", "IMMUTABLE=YES", nullptr};
  // An absolute name is necessary, because GDAL may take other names for addresses or for parts of files.
  return GDALDatasetUniquePtr(GDALDataset::Open(
      plain_name(file).c_str(), GDAL_OF_RASTER | GDAL_OF_VECTOR | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR,
      drivers.data(), format == FileFormat::geopackage ? unlocked.data() : nullptr));
}

/// Returns whether a raster refers to another file for its overviews. GDAL would open that file with any
/// driver, and its netCDF driver contacts hosts.
bool sends_elsewhere(GDALDataset& dataset) {
  const auto sends = [](GDALMajorObject& object) { return object.GetMetadata("OVERVIEWS") != nullptr; };
  if (sends(dataset)) return true;
  for (int band = 1; band <= std::min(dataset.GetRasterCount(), 64); ++band)
    if (sends(*dataset.GetRasterBand(band))) return true;
  return false;
}

/// Returns the message for a band in blocks (strips, tiles, chunks) larger than limits::block_bytes, with
/// the command that repairs it; empty for other bands. GDAL holds at least one whole block, even if it
/// reads little of it and the block has few bytes in the file.
std::optional<std::string> too_large_block(GDALRasterBand& band, const std::string& command) {
  int columns = 0, rows = 0;
  band.GetBlockSize(&columns, &rows);
  const std::int64_t bytes = std::int64_t{columns} * GDALGetDataTypeSizeBytes(band.GetRasterDataType());
  if (rows <= 0 || bytes <= limits::block_bytes / rows) return std::nullopt;
  return fmt::format(
      "is stored in blocks of {} x {} cells, which are larger than {} MB each: write a copy in smaller "
      "blocks with {}",
      columns, rows, limits::block_bytes >> 20, command);
}

constexpr const char* in_tiles = "gdal_translate -co TILED=YES";

std::string overview(const fs::path& file, GDALDataset& dataset) {
  std::array<double, 6> transform{};
  dataset.GetGeoTransform(transform.data());
  return fmt::format(
      "has variable resolution, and its raster is only a coarse overview: resample it to one resolution with "
      "{} (only a [[terrain]] can read grids of variable resolution)",
      advised_resampling(file, std::abs(transform[1]), std::abs(transform[5])));
}

/// Returns the message for such a raster. A copy without metadata has no overviews in another file.
std::string elsewhere(const fs::path& file) {
  return fmt::format(
      "refers to another file for its overviews, which tubefoot does not read: write a copy without "
      "overviews with {}",
      advised_command(fmt::format("gdalwarp -ovr NONE -nomd {}", warp_classes), file));
}

bool is_netcdf(FileFormat format) {
  return format == FileFormat::netcdf4 || format == FileFormat::netcdf_classic;
}

bool has_geotransform(GDALDataset& dataset) {
  std::array<double, 6> ignored{};
  return dataset.GetGeoTransform(ignored.data()) == CE_None;
}

/// Calls `fail` for a netCDF source of a virtual raster whose rows run along x, because GDAL would misread
/// it.
void refuse_turned_over(const fs::path& part, GDALDataset& source,
                        const std::function<void(const std::string&)>& fail) {
  const NetcdfGrid grid = netcdf_grid(part, source);
  if (grid.turned_over)
    fail(fmt::format("is a virtual raster of '{}', which {}", part.string(), grid.problem));
  if (grid.first_row_is_north && grid.geotransform && !has_geotransform(source))
    fail(fmt::format(
        "is a virtual raster of '{}', whose rows GDAL reads in the wrong order: write that file again with "
        "{}, and build the virtual raster from the new file",
        part.string(),
        advised_command("gdal_translate " + grid.placing(source.GetRasterXSize(), source.GetRasterYSize()),
                        part)));
}

/// Returns the file of corrections that a coordinate reference system names, or the keyword that names it;
/// empty if there is none. The check uses the texts of GDAL and PROJ, so that the spelling in the file does
/// not matter. It covers all systems of the dataset, because GDAL may need any of them later.
std::string named_by_crs(GDALDataset& dataset, const GdalAccess& access) {
  GridWords words;
  const auto look_at = [&](const OGRSpatialReference* crs) {
    if (crs == nullptr) return;
    const CPLErrorHandlerPusher quiet(
        CPLQuietErrorHandler);  // some systems cannot be expressed in both formats
    for (const char* format : {"FORMAT=WKT1_GDAL", "FORMAT=WKT2_2019"}) {
      const std::array<const char*, 2> options{format, nullptr};
      char* text = nullptr;
      crs->exportToWkt(&text, options.data());
      if (text != nullptr) words.feed(text);
      CPLFree(text);
    }
  };
  look_at(dataset.GetSpatialRef());
  look_at(dataset.GetGCPSpatialRef());
  for (OGRLayer* layer : dataset.GetLayers())
    for (int field = 0; field < layer->GetLayerDefn()->GetGeomFieldCount(); ++field)
      look_at(layer->GetLayerDefn()->GetGeomFieldDefn(field)->GetSpatialRef());
  return access.rejected_by_proj().empty() ? std::string(words.met()) : access.rejected_by_proj();
}

/// Throws InputError for a virtual raster with a source that cannot be read or has overlarge blocks. The
/// blocks of the virtual raster do not show the blocks of its sources.
void check_sources(const fs::path& vrt, const std::vector<fs::path>& companions) {
  const GdalMessages messages;
  const GdalAccess access(companions);
  const auto fail = [&](const std::string& what) {
    throw InputError({vrt.string(), 0, 0}, what + messages.in_brackets());
  };
  for (const fs::path& part : companions) {
    const FileFormat format = format_of(part);
    if (format == FileFormat::vrt || format == FileFormat::other) continue;
    const GDALDatasetUniquePtr source = opened(part, format);
    if (source == nullptr)
      fail(fmt::format("is a virtual raster of '{}', which cannot be read as {}", part.string(),
                       name_of(format)));
    if (sends_elsewhere(*source))
      fail(fmt::format("is a virtual raster of '{}', which {}", part.string(), elsewhere(part)));
    if (const std::string named = named_by_crs(*source, access); !named.empty())
      fail(fmt::format("is a virtual raster of '{}', which {}", part.string(), names_grids(named)));
    if (format == FileFormat::bag && has_bag_refinements(part))
      fail(fmt::format("is a virtual raster of '{}', which {}", part.string(), overview(part, *source)));
    if (source->GetRasterCount() == 0) continue;
    if (const auto problem = too_large_block(*source->GetRasterBand(1), advised_command(in_tiles, part)))
      fail(fmt::format("is a virtual raster of '{}', which {}", part.string(), *problem));
    if (is_netcdf(format)) refuse_turned_over(part, *source, fail);
  }
}

/// Returns `file` and its companions. A cache holds the most recent results, because a virtual raster may
/// have thousands of sources and is opened for each tile of a terrain.
std::vector<fs::path> with_companions(const fs::path& file) {
  struct Met {
    fs::path file;
    FileState state;
    std::vector<fs::path> admitted;
  };
  constexpr std::size_t most_met = 16;
  static std::mutex mutex;
  static std::deque<Met> met;
  const auto state = state_of(file);
  {
    const std::lock_guard lock(mutex);
    for (const Met& one : met)
      if (state && one.file == file && one.state == *state) return one.admitted;
  }
  std::vector<fs::path> admitted = companions_of(file);
  const bool virtual_raster = format_of(file) == FileFormat::vrt;
  if (virtual_raster) check_sources(file, admitted);
  admitted.push_back(file);
  if (virtual_raster && state) {
    const std::lock_guard lock(mutex);
    met.push_back({file, *state, admitted});
    if (met.size() > most_met) met.pop_front();
  }
  return admitted;
}

}  // namespace

std::string crs_text(const OGRSpatialReference* crs) {
  if (crs == nullptr || crs->IsEmpty() || crs->IsLocal()) return {};
  char* text = nullptr;
  crs->exportToWkt(&text);
  std::string wkt = text == nullptr ? "" : text;
  CPLFree(text);
  return wkt;
}

GdalInput::GdalInput(const fs::path& file, std::initializer_list<FileFormat> expected, Variable variable)
    : place_{file.string(), 0, 0}, access_(with_companions(file)) {
  const FileFormat format = format_of(file);
  if (std::ranges::find(expected, format) == expected.end())
    fail(fmt::format("cannot be read as {}: it is {}; {} converts many formats", list_of(expected),
                     format == FileFormat::other ? "empty, cut off or in another format"
                                                 : fmt::format("a {}", name_of(format)),
                     std::ranges::find(expected, FileFormat::geotiff) == expected.end()
                         ? advised_ogr2ogr("", file)
                         : advised_command("gdal_translate", file)));
  dataset_ = opened(file, format);
  if (dataset_ == nullptr)
    fail(fmt::format("cannot be read as {}: it is cut off or corrupt", name_of(format)));
  if (sends_elsewhere(*dataset_)) fail(elsewhere(file));
  if (const std::string named = named_by_crs(*dataset_, access_); !named.empty()) fail(names_grids(named));
  variable_resolution_ = format == FileFormat::bag && has_bag_refinements(file);
  if (variable == Variable::refused && variable_resolution_) fail(overview(file, *dataset_));
  if (is_netcdf(format) && dataset_->GetRasterCount() > 0) {
    NetcdfGrid grid = netcdf_grid(file, *dataset_);
    if (grid.turned_over) fail(grid.problem);
    in_degrees_ = grid.in_degrees;
    if (!has_geotransform(*dataset_)) {
      const NetcdfRowOrder order(grid.first_row_is_north);
      const CPLErrorHandlerPusher quiet(CPLQuietErrorHandler);  // messages() already has these messages
      dataset_ = opened(file, format);
      if (dataset_ == nullptr) fail("cannot be read a second time");
      netcdf_ = std::move(grid);
    }
  }
}

std::optional<std::array<double, 6>> GdalInput::geotransform() const {
  std::array<double, 6> transform{};
  if (dataset_->GetGeoTransform(transform.data()) == CE_None) return transform;
  return netcdf_ ? netcdf_->geotransform : std::nullopt;
}

std::string GdalInput::no_geotransform(std::string_view otherwise) const {
  if (netcdf_ && !netcdf_->problem.empty()) return netcdf_->problem;
  constexpr std::string_view edges = "-a_ullr WEST NORTH EAST SOUTH";
  const std::string file = place_.file, what = fmt::format(
                                            "has no geotransform, so its cells have no size and position: "
                                            "{}write a copy with the coordinates of its edges by ",
                                            otherwise.empty() ? "" : fmt::format("{}, or ", otherwise));
  if (dataset_->GetMetadata("GEOLOCATION") != nullptr)
    return fmt::format(
        "has two-dimensional coordinates instead of a geotransform, and tubefoot does not read such "
        "coordinates: write a copy on a regular grid with {}",
        advised_command(fmt::format("gdalwarp -geoloc -t_srs EPSG:... {}", warp_heights), file));
  if (!netcdf_) return what + advised_command(fmt::format("gdal_translate {}", edges), file);
  return fmt::format(
      "{}{} if the first row of the variable is the southernmost, or {} if it is the northernmost", what,
      advised_command(fmt::format("gdal_translate {} {}", NetcdfRowOrder::option(false), edges), file),
      advised_command(fmt::format("gdal_translate {} {}", NetcdfRowOrder::option(true), edges), file));
}

std::string GdalInput::no_single_raster() const {
  std::vector<std::string> names;
  for (CSLConstList item = dataset_->GetMetadata("SUBDATASETS"); item != nullptr && *item != nullptr; ++item)
    if (const std::string text = *item; text.find("_NAME=") != text.npos && names.size() < 20)
      names.push_back(text.substr(text.rfind(':') + 1));
  return fmt::format("does not hold a single raster{}: extract one of its variables with {}",
                     names.empty() ? "" : fmt::format(", but the variables {}", fmt::join(names, ", ")),
                     advised_command("gdalmdimtranslate -array VARIABLE", place_.file, ".nc"));
}

std::optional<std::string> GdalInput::unknown_row_order() const {
  if (!netcdf_ || netcdf_->says_rows) return std::nullopt;
  const auto copy = [this](bool first_row_is_north) {
    return advised_command(fmt::format("gdal_translate {}", NetcdfRowOrder::option(first_row_is_north)),
                           place_.file);
  };
  return fmt::format(
      "has no coordinates that show which row is the northernmost: write a copy with {} if it is the first "
      "row, or with {} if it is the last row",
      copy(true), copy(false));
}

std::string GdalInput::advised(std::string_view command) const {
  const fs::path file = place_.file;
  if (!netcdf_ || !netcdf_->geotransform) return advised_command(command, file);
  const std::string placed = shell_word(new_file_beside(file, ".tif"));
  return fmt::format("`gdal_translate {} {} {} && {} {} {}`",
                     netcdf_->placing(dataset_->GetRasterXSize(), dataset_->GetRasterYSize()),
                     shell_word(file), placed, command, placed, shell_word(new_file_beside(file, ".tif", 2)));
}

std::string GdalInput::name_the_degrees() const {
  return fmt::format(
      "add a coordinate reference system with {} (WGS 84), or convert the coordinates to metres with {}",
      advised("gdal_translate -a_srs EPSG:4326"),
      advised(fmt::format("gdalwarp -s_srs EPSG:4326 -t_srs EPSG:... {}", warp_heights)));
}

std::string GdalInput::crs() const {
  const OGRSpatialReference* const known = dataset_->GetSpatialRef();
  if (std::string text = crs_text(known); !text.empty()) return text;
  if (known != nullptr && known->IsLocal()) return {};
  const auto fail_as_degrees = [this](std::string_view text) {
    fail(fmt::format(
        "its coordinates are in degrees ({}), but it has no coordinate reference system: {}; if the "
        "coordinates are in metres, as in small local grids that GDAL writes, declare this with {}",
        text, name_the_degrees(), advised("gdal_translate -a_srs 'LOCAL_CS[\"local\",UNIT[\"metre\",1]]'")));
  };
  // Metadata in the form of GDAL's netCDF driver: "lon#units=degrees_east".
  for (CSLConstList item = dataset_->GetMetadata(); item != nullptr && *item != nullptr; ++item)
    if (const std::string_view text = *item; text.find("#units=degree") != text.npos) fail_as_degrees(text);
  if (in_degrees_) fail_as_degrees("according to their names");
  return {};
}

void GdalInput::refuse_colours(const char* what, bool palettes_too) const {
  const GDALColorInterp means = dataset_->GetRasterBand(1)->GetColorInterpretation();
  if (means >= GCI_RedBand || (palettes_too && means == GCI_PaletteIndex))
    fail(
        fmt::format("is a colour picture, and colours are not {}: if one of its bands holds the data, "
                    "extract that band with {}",
                    what, advised("gdal_translate -b BAND -colorinterp_1 gray")));
}

void GdalInput::read_row(GDALRasterBand& band, int row, int column, int columns, GDALDataType type,
                         void* out) const {
  stop_if_wanted();
  if (const auto problem = too_large_block(band, advised(in_tiles))) fail(*problem);
  const CPLErr read = band.RasterIO(GF_Read, column, row, columns, 1, out, columns, 1, type, 0, 0, nullptr);
  if (const std::string& named = access_.rejected_by_proj(); !named.empty()) fail(names_grids(named));
  if (read == CE_None) return;
  // GDAL's last message names the file, which may be one of many in a virtual raster.
  const auto& told = messages_.failures();
  fail(fmt::format("row {} cannot be read: the file is cut off or corrupt{}", row,
                   told.size() > 1 ? ": " + told.back() : ""));
}

void GdalInput::fail(const std::string& message) const {
  throw InputError(place_, message + messages_.in_brackets());
}

}  // namespace tubefoot
