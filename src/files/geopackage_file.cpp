// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/geopackage_file.hpp"

#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <cctype>
#include <memory>
#include <string>

#include "files/inlet.hpp"
#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

/// As SQLite wants a name in an address: with everything but letters and digits as %2f.
std::string address_of(const fs::path& file) {
  std::string address = "file:";
  for (const char c : fs::absolute(file).string())
    address += std::isalnum(static_cast<unsigned char>(c)) || c == '/'
                   ? std::string(1, c)
                   : fmt::format("%{:02x}", static_cast<unsigned char>(c));
  return address + "?immutable=1";
}

/// In small letters, without comments, one space for any, and for whatever stands in quotes a q.
std::string plain(const std::string& sql) {
  std::string result;
  const auto blank = [&result] {
    if (!result.empty() && result.back() != ' ') result += ' ';
  };
  for (std::size_t at = 0; at < sql.size(); ++at) {
    const char c = sql[at];
    if (sql.compare(at, 2, "--") == 0) {
      at = std::min(sql.find('\n', at), sql.size() - 1);
      blank();
    } else if (sql.compare(at, 2, "/*") == 0) {
      const std::size_t end = sql.find("*/", at + 2);
      at = end == sql.npos ? sql.size() : end + 1;
      blank();
    } else if (c == '\'' || c == '"' || c == '`' || c == '[') {
      at = std::min(sql.find(c == '[' ? ']' : c, at + 1), sql.size() - 1);
      blank();
      result += "q ";
    } else if (std::isspace(static_cast<unsigned char>(c))) {
      blank();
    } else {
      result += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
  }
  return result;
}

/// What is wrong with an entry of the schema. What it says of its type itself is not heeded: SQLite goes by
/// the text.
std::string surprise_in(const std::string& sql) {
  const auto begins = [&sql](std::string_view words) { return sql.starts_with(words); };
  if (begins("create virtual table ")) {
    const std::size_t kind = sql.find(" using ");
    return kind != sql.npos && sql.compare(kind, 13, " using rtree(") == 0 ? "" : "a virtual table";
  }
  if (begins("create table "))
    return sql.find(" as (") != sql.npos || sql.find(" as(") != sql.npos ? "a table with computed columns"
                                                                         : "";
  if (sql.empty() || begins("create index ") || begins("create unique index ") || begins("create trigger "))
    return "";  // triggers are for those who write
  return "a view";
}

/// Whoever does not want to wait is not kept.
int stop(void*) { return stop_wanted() ? 1 : 0; }

/// Answers of one text or number; empty for none.
std::string answer(sqlite3* database, const char* question) {
  sqlite3_stmt* prepared = nullptr;
  if (sqlite3_prepare_v2(database, question, -1, &prepared, nullptr) != SQLITE_OK) return {};
  const std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)> rows(prepared, sqlite3_finalize);
  if (sqlite3_step(prepared) != SQLITE_ROW) return {};
  const unsigned char* value = sqlite3_column_text(prepared, 0);
  return value == nullptr ? "" : reinterpret_cast<const char*>(value);
}

}  // namespace

void refuse_geopackage_surprises(const fs::path& file) {
  const auto fail = [&file](const std::string& what) { throw InputError({file.string(), 0, 0}, what); };
  const auto written_to = [&fail](const std::string& what) {
    fail(fmt::format(
        "is being written to, or was when a program ended: {}; open it in that program once more and close "
        "it, or copy it with ogr2ogr",
        what));
  };
  for (const char* suffix : {"-wal", "-journal", "-shm"}) {
    const fs::path beside = fs::path(file) += suffix;
    std::error_code error;
    if (fs::exists(fs::symlink_status(beside, error)) &&
        (!fs::is_regular_file(beside, error) || !fs::is_empty(beside, error)))
      written_to(fmt::format("'{}' has changes that are not in it", beside.filename().string()));
  }
  constexpr std::size_t format_version =
      18;  // of those who write, then of those who read: 2 is a write-ahead log
  const std::string head = InputFile(file).head(100);
  if (head.size() < 100 || head[format_version] != 1 || head[format_version + 1] != 1)
    written_to("its changes would go to a log beside it");
  sqlite3* opened = nullptr;
  const int status =
      sqlite3_open_v2(address_of(file).c_str(), &opened,
                      SQLITE_OPEN_READONLY | SQLITE_OPEN_URI | SQLITE_OPEN_PRIVATECACHE, nullptr);
  const std::unique_ptr<sqlite3, int (*)(sqlite3*)> database(opened, sqlite3_close);
  sqlite3_limit(opened, SQLITE_LIMIT_LENGTH, 64 << 20);
  sqlite3_stmt* prepared = nullptr;
  if (status != SQLITE_OK ||
      sqlite3_prepare_v2(opened, "SELECT name, sql FROM sqlite_master", -1, &prepared, nullptr) != SQLITE_OK)
    fail("cannot be read as GeoPackage: it is cut off or damaged");
  const std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)> rows(prepared, sqlite3_finalize);
  int step = SQLITE_ROW;
  while ((step = sqlite3_step(prepared)) == SQLITE_ROW) {
    const auto text = [prepared](int column) {
      const unsigned char* value = sqlite3_column_text(prepared, column);
      return std::string(value == nullptr ? "" : reinterpret_cast<const char*>(value));
    };
    if (const std::string surprise = surprise_in(plain(text(1))); !surprise.empty())
      fail(fmt::format("has {}, '{}', which is not read: save its layer as a plain table (ogr2ogr)", surprise,
                       text(0)));
  }
  if (step != SQLITE_DONE) fail("cannot be read as GeoPackage: it is cut off or damaged");
  // Pages that stand in several tables are rows without end. What a table demands of its rows is a program,
  // too.
  sqlite3_progress_handler(opened, 10000, stop, nullptr);
  answer(opened, "PRAGMA ignore_check_constraints=ON");
  const std::string checked = answer(opened, "PRAGMA quick_check(1)");
  stop_if_wanted();
  if (checked != "ok")
    fail(fmt::format("cannot be read as GeoPackage: it is damaged ({})", checked.substr(0, 200)));
  if (answer(opened, "PRAGMA encoding") != "UTF-8") fail("is not written in UTF-8: copy it with ogr2ogr");
  const std::string longest = answer(opened, "SELECT max(length(definition)) FROM gpkg_spatial_ref_sys");
  if (longest.size() > 5) fail("has a coordinate reference system of more than 99999 letters");
}

}  // namespace tubefoot
