// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that only src/files opens, writes, moves or removes files, through one entry point for each
// operation (docs/limits.md).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

/// Returns the matching lines of a file except for comments: "src/app/run.cpp:12: ...".
std::vector<std::string> lines_with(const fs::path& file, const std::regex& pattern) {
  std::vector<std::string> found;
  std::ifstream in(file);
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    const std::string code = line.substr(0, line.find("//"));
    if (!std::regex_search(code, pattern)) continue;
    found.push_back(fs::relative(file, TUBEFOOT_SOURCE_DIR).string() + ":" + std::to_string(number) + ": " +
                    line);
  }
  return found;
}

/// Searches all code of the program and the Python module except src/files and the named files.
std::vector<std::string> outside_of_gdal_access(const std::string& pattern,
                                                const std::vector<std::string>& allowed = {}) {
  std::vector<std::string> found;
  const std::regex words(pattern);
  for (const char* folder : {"geometry", "sensors", "src", "python/native"})
    for (const fs::directory_entry& entry :
         fs::recursive_directory_iterator(fs::path(TUBEFOOT_SOURCE_DIR) / folder)) {
      const std::string name = fs::relative(entry.path(), TUBEFOOT_SOURCE_DIR).string();
      const std::string extension = entry.path().extension().string();
      if ((extension != ".cpp" && extension != ".hpp") || name.starts_with("src/files/")) continue;
      if (std::find(allowed.begin(), allowed.end(), name) != allowed.end()) continue;
      for (std::string& line : lines_with(entry.path(), words)) found.push_back(std::move(line));
    }
  return found;
}

using testing::IsEmpty;

TEST(Doors, FilesAreReadThroughTheInputRegistry) {
  EXPECT_THAT(
      outside_of_gdal_access(R"(\bifstream\b|\bfstream\b|\bfopen\s*\(|\bfreopen\s*\(|H5Fopen|sqlite3_open)"),
      IsEmpty());
  EXPECT_THAT(outside_of_gdal_access(R"(\bnc_open\s*\()", {"sensors/recordings/netcdf_group.hpp",
                                                           "sensors/formats/netcdf_stream.cpp"}),
              IsEmpty());
  EXPECT_THAT(
      outside_of_gdal_access(R"(GDALDataset::Open|\bGDALOpen|\bOGROpen|GDALAllRegister|ImageInput::open)",
                             {"src/footprints/footprint_file_ogr.cpp"}),  // reads the file that it wrote
      IsEmpty());
  EXPECT_THAT(outside_of_gdal_access(R"(parse_file\s*\(|CPLParseXMLFile|VSIFOpen)"), IsEmpty());
}

TEST(Doors, FilesAreWrittenThroughTheAtomicOutput) {
  EXPECT_THAT(outside_of_gdal_access(R"(\bofstream\b|\bmkstemp|\bmkdtemp|\btmpfile\s*\()"), IsEmpty());
  EXPECT_THAT(
      outside_of_gdal_access(
          R"((fs::|filesystem::|std::|::)(rename|copy_file|create_directory|create_directories)\s*\()"),
      IsEmpty());
  EXPECT_THAT(outside_of_gdal_access(R"(\b(renameat|renameat2|unlinkat|symlink|linkat)\s*\()"), IsEmpty());
}

}  // namespace
