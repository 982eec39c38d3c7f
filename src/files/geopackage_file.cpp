// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/geopackage_file.hpp"

#include <fmt/format.h>

#include <string>

#include "files/advised_command.hpp"
#include "files/grid_words.hpp"
#include "files/input_registry.hpp"
#include "files/sqlite_file.hpp"
#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

SqliteWords words_for(const fs::path& file) {
  return {"GeoPackage", "save its layers as plain tables with " + advised_ogr2ogr("", file),
          "open and close the file again in that program, or copy it with " + advised_ogr2ogr("", file)};
}

/// Returns the first text or number of an answer; empty if there is none, or if the file cannot answer the
/// question.
std::string answer(const SqliteFile& database, const char* question) {
  std::string said;
  try {
    database.ask(question, {}, [&said](const SqliteFile::Row& row) {
      if (said.empty()) said = row.text(0);
    });
  } catch (const InputError&) {
    return {};
  }
  return said;
}

/// Rejects the file if one of its coordinate reference systems names a file of corrections. SQLite joins
/// text across pages of the file, so that a keyword is found even if a page ends within it.
void reject_grid_words(const SqliteFile& database) {
  const auto fail = [&](const std::string& what) {
    throw InputError({database.path().string(), 0, 0}, what);
  };
  constexpr std::size_t most_letters = 99'999;
  // The second column exists only in files with the extension for WKT 2.
  for (const char* column : {"definition", "definition_12_063"}) {
    const std::string longest =
        answer(database, fmt::format("SELECT max(length({})) FROM gpkg_spatial_ref_sys", column).c_str());
    if (longest.empty()) continue;
    if (longest.size() > 5)
      fail(fmt::format("has a coordinate reference system of more than {} characters", most_letters));
    database.ask(fmt::format("SELECT {} FROM gpkg_spatial_ref_sys", column).c_str(), {},
                 [&](const SqliteFile::Row& row) {
                   stop_if_wanted();
                   GridWords words;
                   words.feed(row.text(0));
                   if (!words.met().empty()) fail(names_grids(words.met()));
                 });
  }
}

}  // namespace

void refuse_geopackage_surprises(const fs::path& file) {
  const auto fail = [&file](const std::string& what) { throw InputError({file.string(), 0, 0}, what); };
  const SqliteWords words = words_for(file);
  refuse_unfinished_sqlite(file, words);
  constexpr std::size_t format_version =
      18;  // offset of the format versions for writing and for reading; version 2 means a write-ahead log
  const std::string head = InputFile(file).head(100);
  if (head.size() < 100 || head[format_version] != 1 || head[format_version + 1] != 1)
    refuse_as_unfinished(file, words, "it keeps its changes in a separate log");
  const SqliteFile database(file, words);
  // A page that occurs in several tables would give an endless number of rows. Check constraints of a table
  // are programs as well, and are ignored.
  answer(database, "PRAGMA ignore_check_constraints=ON");
  const std::string checked = answer(database, "PRAGMA quick_check(1)");
  stop_if_wanted();
  if (checked != "ok")
    fail(fmt::format("cannot be read as GeoPackage: it is damaged ({})", checked.substr(0, 200)));
  if (answer(database, "PRAGMA encoding") != "UTF-8")
    fail("is not encoded in UTF-8: copy it with " + advised_ogr2ogr("", file));
  reject_grid_words(database);
}

}  // namespace tubefoot
