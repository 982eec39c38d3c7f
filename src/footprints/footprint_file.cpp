// SPDX-License-Identifier: GPL-3.0-or-later
#include "footprints/footprint_file.hpp"

#include <fmt/format.h>

#include <array>
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
      "'{}': unknown suffix: expected .gpkg, .geojson, .csv, .vtp, .obj, .ply, .nc or .txt (exact corners)",
      file.string()));
}

}  // namespace tubefoot
