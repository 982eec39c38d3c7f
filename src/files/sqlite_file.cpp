// SPDX-License-Identifier: GPL-3.0-or-later

// Opens untrusted SQLite databases for reading. It checks the length and the schema, and an authorizer
// permits only reading of tables.

#include "files/sqlite_file.hpp"

#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <cctype>

#include "files/absolute_path.hpp"
#include "files/input_registry.hpp"
#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

/// Returns a file name as SQLite needs it in a URI: characters except letters, digits and '/' become %20
/// and the like.
std::string address_of(const fs::path& file) {
  std::string address = "file:";
  for (const char c : absolute_path(file).string())
    address += std::isalnum(static_cast<unsigned char>(c)) || c == '/'
                   ? std::string(1, c)
                   : fmt::format("%{:02x}", static_cast<unsigned char>(c));
  return address + "?immutable=1";
}

/// Returns SQL in lower case, without comments, with single spaces, and with q for any quoted text.
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

/// Returns the problem of an entry of the schema. The check ignores the entry's declared type, because
/// SQLite uses only the text.
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
    return "";  // triggers only affect writers
  return "a view";
}

/// Interrupts a query on a stop request.
int stop(void*) { return stop_wanted() ? 1 : 0; }

/// Permits reading of tables and the checks for damage, and denies all other actions. Reading an R-tree
/// prepares its own changes (SQLite 3.46 does so in a check). They are never executed, because the file is
/// open for reading only.
int only_reading(void*, int action, const char*, const char*, const char*, const char*) {
  switch (action) {
    case SQLITE_SELECT:
    case SQLITE_READ:
    case SQLITE_FUNCTION:
    case SQLITE_PRAGMA:
    case SQLITE_INSERT:
    case SQLITE_UPDATE:
    case SQLITE_DELETE:
      return SQLITE_OK;
    default:
      return SQLITE_DENY;
  }
}

constexpr std::size_t header_bytes = 100;

using Statement = std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)>;

Statement prepared(sqlite3* database, const char* question) {
  sqlite3_stmt* statement = nullptr;
  const int status = sqlite3_prepare_v2(database, question, -1, &statement, nullptr);
  return {status == SQLITE_OK ? statement : nullptr, sqlite3_finalize};
}

}  // namespace

void refuse_as_unfinished(const fs::path& file, const SqliteWords& words, const std::string& what) {
  throw InputError(
      {file.string(), 0, 0},
      fmt::format("is being written, or a program stopped while writing it: {}; {}", what, words.finish));
}

void refuse_unfinished_sqlite(const fs::path& file, const SqliteWords& words) {
  for (const char* suffix : {"-wal", "-journal", "-shm"}) {
    const fs::path beside = fs::path(file) += suffix;
    std::error_code error;
    if (fs::exists(fs::symlink_status(beside, error)) &&
        (!fs::is_regular_file(beside, error) || !fs::is_empty(beside, error)))
      refuse_as_unfinished(
          file, words,
          fmt::format("'{}' contains changes that are not yet in the file", beside.filename().string()));
  }
}

SqliteFile::SqliteFile(fs::path file, const SqliteWords& words)
    : path_(std::move(file)), kind_(words.kind), database_(nullptr, sqlite3_close) {
  refuse_unfinished_sqlite(path_, words);
  InputFile input(path_);  // checks that the file is regular
  bytes_ = input.size();
  const std::string head = input.head(header_bytes);
  check_length({reinterpret_cast<const std::uint8_t*>(head.data()), head.size()});
  sqlite3* opened = nullptr;
  const int status =
      sqlite3_open_v2(address_of(path_).c_str(), &opened,
                      SQLITE_OPEN_READONLY | SQLITE_OPEN_URI | SQLITE_OPEN_PRIVATECACHE, nullptr);
  database_.reset(opened);
  if (status != SQLITE_OK) fail("it is cut off or damaged");
  check_schema(words);
}

SqliteFile::SqliteFile(fs::path file, std::vector<std::uint8_t> bytes, const SqliteWords& words)
    : path_(std::move(file)),
      kind_(words.kind),
      memory_(std::move(bytes)),
      database_(nullptr, sqlite3_close) {
  bytes_ = memory_.size();
  check_length(memory_);
  constexpr std::size_t format_version = 18;
  // Version 2 means a write-ahead log, which does not exist in memory.
  memory_[format_version] = memory_[format_version + 1] = 1;
  sqlite3* opened = nullptr;
  const int status = sqlite3_open_v2(":memory:", &opened, SQLITE_OPEN_READWRITE, nullptr);
  database_.reset(opened);
  const auto size = static_cast<sqlite3_int64>(memory_.size());
  if (status != SQLITE_OK || sqlite3_deserialize(opened, "main", memory_.data(), size, size,
                                                 SQLITE_DESERIALIZE_READONLY) != SQLITE_OK)
    fail("it is cut off or damaged");
  check_schema(words);
}

void SqliteFile::fail(const std::string& what) const {
  stop_if_wanted();
  throw InputError({path_.string(), 0, 0}, fmt::format("cannot be read as {}: {}", kind_, what));
}

/// SQLite itself notices a missing page only when it reads that page.
void SqliteFile::check_length(std::span<const std::uint8_t> header) const {
  if (header.size() < header_bytes) fail("it is cut off or damaged");
  const auto number = [&header](std::size_t at, int bytes) {
    std::uint64_t value = 0;
    for (int k = 0; k < bytes; ++k) value = value << 8 | header[at + static_cast<std::size_t>(k)];
    return value;
  };
  constexpr std::size_t page_size = 16, changes = 24, pages = 28, pages_valid_for = 92;
  const std::uint64_t page = number(page_size, 2) == 1 ? 65536 : number(page_size, 2);
  // Programs before 2010 do not update the number of pages.
  if (number(changes, 4) == number(pages_valid_for, 4) && number(pages, 4) * page > bytes_)
    fail(fmt::format("it is cut off: it has only {} of {} bytes", bytes_, number(pages, 4) * page));
}

void SqliteFile::check_schema(const SqliteWords& words) const {
  sqlite3* const database = database_.get();
  sqlite3_limit(database, SQLITE_LIMIT_LENGTH, 1 << 30);
  sqlite3_limit(database, SQLITE_LIMIT_ATTACHED, 0);
  for (const int setting : {SQLITE_DBCONFIG_TRUSTED_SCHEMA, SQLITE_DBCONFIG_ENABLE_TRIGGER,
                            SQLITE_DBCONFIG_ENABLE_VIEW, SQLITE_DBCONFIG_ENABLE_LOAD_EXTENSION})
    sqlite3_db_config(database, setting, 0, nullptr);
  sqlite3_db_config(database, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_set_authorizer(database, only_reading, nullptr);
  sqlite3_progress_handler(database, 10000, stop, nullptr);
  std::size_t entries = 0;
  ask("SELECT name, sql FROM sqlite_master", {}, [&](const Row& row) {
    constexpr std::size_t most_entries = 100'000;
    if (++entries > most_entries) fail("its schema has too many entries");
    if (const std::string surprise = surprise_in(plain(row.text(1))); !surprise.empty())
      throw InputError({path_.string(), 0, 0}, fmt::format("has {}, '{}', which tubefoot does not read: {}",
                                                           surprise, row.text(0), words.plain_tables));
  });
}

void SqliteFile::ask(const char* question, std::span<const std::int64_t> numbers,
                     const std::function<void(const Row&)>& use) const {
  const Statement statement = prepared(database_.get(), question);
  if (!statement) {
    const std::string reason = sqlite3_errmsg(database_.get());
    fail(reason.starts_with("no such") ? reason : "it is cut off or damaged (" + reason + ")");
  }
  for (std::size_t k = 0; k < numbers.size(); ++k)
    sqlite3_bind_int64(statement.get(), static_cast<int>(k) + 1, numbers[k]);
  int step = SQLITE_ROW;
  while ((step = sqlite3_step(statement.get())) == SQLITE_ROW) use(Row(statement.get()));
  if (step != SQLITE_DONE)
    fail(fmt::format("it is cut off or damaged ({})", sqlite3_errmsg(database_.get())));
}

bool SqliteFile::has_table(std::string_view name) const {
  bool found = false;
  ask("SELECT name FROM sqlite_master", {}, [&](const Row& row) { found = found || row.text(0) == name; });
  return found;
}

std::int64_t SqliteFile::Row::integer(int column) const { return sqlite3_column_int64(statement_, column); }

std::string SqliteFile::Row::text(int column) const {
  const unsigned char* const value = sqlite3_column_text(statement_, column);
  return value == nullptr ? "" : reinterpret_cast<const char*>(value);
}

bool SqliteFile::Row::is_blob(int column) const {
  return sqlite3_column_type(statement_, column) == SQLITE_BLOB;
}

std::span<const std::uint8_t> SqliteFile::Row::blob(int column) const {
  const void* const data = sqlite3_column_blob(statement_, column);
  return {static_cast<const std::uint8_t*>(data),
          data == nullptr ? 0 : static_cast<std::size_t>(sqlite3_column_bytes(statement_, column))};
}

}  // namespace tubefoot
