// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/geopackage_file.hpp"

#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <cctype>
#include <memory>
#include <string>

#include "files/input_error.hpp"

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

/// In small letters, without comments, one space for any.
std::string plain(const std::string& sql) {
  std::string result;
  for (std::size_t at = 0; at < sql.size(); ++at) {
    if (sql.compare(at, 2, "--") == 0) {
      at = std::min(sql.find('\n', at), sql.size() - 1);
    } else if (sql.compare(at, 2, "/*") == 0) {
      const std::size_t end = sql.find("*/", at + 2);
      at = end == sql.npos ? sql.size() : end + 1;
    } else if (const auto c = static_cast<unsigned char>(sql[at]); !std::isspace(c)) {
      result += static_cast<char>(std::tolower(c));
      continue;
    }
    if (!result.empty() && result.back() != ' ') result += ' ';
  }
  return result;
}

/// What is wrong with an entry of the schema. What it says of its type itself is not heeded: SQLite goes by
/// the text.
std::string surprise_in(const std::string& sql) {
  const auto begins = [&sql](std::string_view words) { return sql.starts_with(words); };
  if (begins("create virtual table "))
    return sql.find(" using rtree") == sql.npos && sql.find(" using \"rtree\"") == sql.npos
               ? "a virtual table"
               : "";
  if (begins("create table ")) {
    const bool computes = sql.find(" as (") != sql.npos || sql.find(" as(") != sql.npos;
    return computes ? "a table with computed columns" : "";
  }
  if (sql.empty() || begins("create index ") || begins("create unique index ") || begins("create trigger "))
    return "";  // triggers are for those who write
  return "a view";
}

}  // namespace

void refuse_geopackage_surprises(const fs::path& file) {
  const auto fail = [&file](const std::string& what) { throw InputError({file.string(), 0, 0}, what); };
  for (const char* suffix : {"-wal", "-journal"}) {
    const fs::path beside = fs::path(file) += suffix;
    std::error_code error;
    if (const auto bytes = fs::file_size(beside, error); !error && bytes > 0)
      fail(fmt::format(
          "is being written to, or was when a program ended: '{}' has changes that are not in it; "
          "open it in that program once more and close it",
          beside.filename().string()));
  }
  sqlite3* opened = nullptr;
  const int status =
      sqlite3_open_v2(address_of(file).c_str(), &opened,
                      SQLITE_OPEN_READONLY | SQLITE_OPEN_URI | SQLITE_OPEN_PRIVATECACHE, nullptr);
  const std::unique_ptr<sqlite3, int (*)(sqlite3*)> database(opened, sqlite3_close);
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
}

}  // namespace tubefoot
