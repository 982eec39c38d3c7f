// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/footprint_file.hpp"

#include <fmt/format.h>

#include <array>
#include <system_error>
#include <utility>

#include "files/usage_error.hpp"

namespace tubefoot {
namespace fs = std::filesystem;
namespace {

constexpr std::array<std::pair<const char*, FootprintFileMaker>, 7> formats{{{".gpkg", geopackage_file},
                                                                             {".geojson", geojson_file},
                                                                             {".csv", csv_file},
                                                                             {".vtp", vtp_file},
                                                                             {".obj", obj_file},
                                                                             {".ply", ply_file},
                                                                             {".nc", netcdf_footprint_file}}};

}  // namespace

FootprintFileMaker footprint_file_maker(const fs::path& file) {
  for (const auto& [ending, make] : formats)
    if (file.extension() == ending) return make;
  throw UsageError(fmt::format(
      "'{}': the ending chooses the format: .gpkg, .geojson, .csv, .vtp, .obj, .ply, .nc or .txt (exact)",
      file.string()));
}

FileBeside::FileBeside(fs::path target) : target_(std::move(target)) {
  if (fs::is_directory(target_))
    throw UsageError(fmt::format("'{}' is a folder: name a file with -o", target_.string()));
  partial_ = target_;
  partial_.replace_filename(".partial-" + target_.filename().string());
  remove();
}

FileBeside::~FileBeside() { remove(); }

void FileBeside::remove() const {
  std::error_code ignored;
  fs::remove(partial_, ignored);
  fs::remove(partial_.string() + "-journal", ignored);  // of a GeoPackage that was not closed
}

void FileBeside::commit() {
  std::error_code failure;
  fs::rename(partial_, target_, failure);
  if (failure)
    throw std::runtime_error(fmt::format("cannot write '{}': {}", target_.string(), failure.message()));
}

}  // namespace tubefoot
