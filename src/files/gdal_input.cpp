// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/gdal_input.hpp"

#include <fmt/ranges.h>
#include <ogrsf_frmts.h>

#include <algorithm>
#include <array>
#include <deque>
#include <mutex>
#include <vector>

#include "files/bag_refinements.hpp"
#include "files/companions.hpp"
#include "files/grid_words.hpp"
#include "files/inlet.hpp"
#include "files/library_settings.hpp"
#include "files/limits.hpp"
#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

/// "GeoTIFF, BAG or VRT"
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
  // SQLite looks for changes beside the file unless it is told that nobody makes any.
  const std::array<const char*, 3> unlocked{"NOLOCK=YES", "IMMUTABLE=YES", nullptr};
  // By an absolute name: others may be taken for addresses or for parts of files.
  return GDALDatasetUniquePtr(GDALDataset::Open(
      plain_name(file).c_str(), GDAL_OF_RASTER | GDAL_OF_VECTOR | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR,
      drivers.data(), format == FileFormat::geopackage ? unlocked.data() : nullptr));
}

/// Where a raster sends its readers for coarser copies of itself: GDAL would open that, whatever it is, with
/// any of its drivers, and netCDF's goes to hosts.
bool sends_elsewhere(GDALDataset& dataset) {
  const auto sends = [](GDALMajorObject& object) { return object.GetMetadata("OVERVIEWS") != nullptr; };
  if (sends(dataset)) return true;
  for (int band = 1; band <= std::min(dataset.GetRasterCount(), 64); ++band)
    if (sends(*dataset.GetRasterBand(band))) return true;
  return false;
}

/// What to say of a band of a raster that is stored in blocks (strips, tiles, chunks) larger than
/// limits::block_bytes, and what to do about it; nothing for others. GDAL holds at least one block whole,
/// however little of it is read and however few bytes it has in the file.
std::optional<std::string> too_large_block(GDALRasterBand& band) {
  int columns = 0, rows = 0;
  band.GetBlockSize(&columns, &rows);
  const std::int64_t bytes = std::int64_t{columns} * GDALGetDataTypeSizeBytes(band.GetRasterDataType());
  if (rows <= 0 || bytes <= limits::block_bytes / rows) return std::nullopt;
  return fmt::format(
      "is stored in blocks of {} x {} cells, which are more than {} MB each: rewrite it with gdal_translate "
      "-co "
      "TILED=YES",
      columns, rows, limits::block_bytes >> 20);
}

constexpr const char* overview =
    "has variable resolution, and its raster is but a coarse overview: write one resolution with "
    "gdal_translate "
    "-oo MODE=RESAMPLED_GRID (a [[terrain]] reads all of it)";

constexpr const char* elsewhere =
    "names another file for its overviews, which is not read: remove them (gdaladdo -clean)";

/// What a coordinate reference system names that is a file of corrections, as GDAL and PROJ understand its
/// text, whatever its spelling in the file: the file, or the word for it; empty: nothing. All of them are
/// looked at, because GDAL may be asked for any of them later.
std::string named_by_crs(GDALDataset& dataset, const GdalDoor& door) {
  GridWords words;
  const auto look_at = [&](const OGRSpatialReference* crs) {
    if (crs == nullptr) return;
    const CPLErrorHandlerPusher quiet(CPLQuietErrorHandler);  // not every one can be said in both
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
  return door.rejected_by_proj().empty() ? std::string(words.met()) : door.rejected_by_proj();
}

/// Throws InputError for a virtual raster with a source that cannot be read, or is stored in blocks that are
/// too large: its own blocks say nothing of theirs.
void check_sources(const fs::path& vrt, const std::vector<fs::path>& companions) {
  const GdalMessages messages;
  const GdalDoor door(companions);
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
      fail(fmt::format("is a virtual raster of '{}', which {}", part.string(), elsewhere));
    if (const std::string named = named_by_crs(*source, door); !named.empty())
      fail(fmt::format("is a virtual raster of '{}', which {}", part.string(), names_grids(named)));
    if (format == FileFormat::bag && has_bag_refinements(part))
      fail(fmt::format("is a virtual raster of '{}', which {}", part.string(), overview));
    if (source->GetRasterCount() == 0) continue;
    if (const auto problem = too_large_block(*source->GetRasterBand(1)))
      fail(fmt::format("is a virtual raster of '{}', which {}", part.string(), *problem));
  }
}

/// `file` and what is read along with it. A virtual raster may have thousands of sources and is opened for
/// each tile of a terrain: of the last ones that were met it is remembered.
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
    : place_{file.string(), 0, 0}, door_(with_companions(file)) {
  const FileFormat format = format_of(file);
  if (std::ranges::find(expected, format) == expected.end())
    fail(fmt::format("cannot be read as {}: it is {} (gdal_translate and ogr2ogr convert many)",
                     list_of(expected),
                     format == FileFormat::other ? "empty, cut off or of another format"
                                                 : fmt::format("a {}", name_of(format))));
  dataset_ = opened(file, format);
  if (dataset_ == nullptr)
    fail(fmt::format("cannot be read as {}: it is cut off or corrupt", name_of(format)));
  if (sends_elsewhere(*dataset_)) fail(elsewhere);
  if (const std::string named = named_by_crs(*dataset_, door_); !named.empty()) fail(names_grids(named));
  variable_resolution_ = format == FileFormat::bag && has_bag_refinements(file);
  if (variable == Variable::refused && variable_resolution_) fail(overview);
}

std::string GdalInput::crs() const {
  if (const std::string known = crs_text(dataset_->GetSpatialRef()); !known.empty()) return known;
  // As netCDF's driver gives them: "lon#units=degrees_east".
  for (CSLConstList item = dataset_->GetMetadata(); item != nullptr && *item != nullptr; ++item)
    if (const std::string_view text = *item; text.find("#units=degree") != text.npos)
      fail(fmt::format(
          "its coordinates are in degrees ({}), but it names no coordinate reference system: {}; if they are "
          "metres after all, as GDAL writes small local grids, drop the word with gdal_translate "
          "-nomd to a GeoTIFF",
          text, name_the_degrees));
  return {};
}

void GdalInput::refuse_colours(const char* what, bool palettes_too) const {
  const GDALColorInterp means = dataset_->GetRasterBand(1)->GetColorInterpretation();
  if (means >= GCI_RedBand || (palettes_too && means == GCI_PaletteIndex))
    fail(fmt::format(
        "is a picture in colours, which are no {}: if one of its bands has them, take that out with "
        "gdal_translate -b N -colorinterp_1 gray",
        what));
}

void GdalInput::read_row(GDALRasterBand& band, int row, int column, int columns, GDALDataType type,
                         void* out) const {
  stop_if_wanted();
  if (const auto problem = too_large_block(band)) fail(*problem);
  const CPLErr read = band.RasterIO(GF_Read, column, row, columns, 1, out, columns, 1, type, 0, 0, nullptr);
  if (const std::string& named = door_.rejected_by_proj(); !named.empty()) fail(names_grids(named));
  if (read == CE_None) return;
  // GDAL's last word names the file, which may be one of many in a virtual raster.
  const auto& told = messages_.failures();
  fail(fmt::format("row {} cannot be read: the file is cut off or corrupt{}", row,
                   told.size() > 1 ? ": " + told.back() : ""));
}

void GdalInput::fail(const std::string& message) const {
  throw InputError(place_, message + messages_.in_brackets());
}

}  // namespace tubefoot
