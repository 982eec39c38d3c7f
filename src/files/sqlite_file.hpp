// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

struct sqlite3;
struct sqlite3_stmt;

// The door to databases of strangers: a schema is a program, rows may be without end.
namespace tubefoot {

/// What is said of a database that is refused.
struct SqliteWords {
  std::string_view kind;     ///< "GeoPackage"
  std::string plain_tables;  ///< what to do about views: "save its layers as plain tables with `ogr2ogr ...`"
  std::string finish;        ///< about changes that stand beside it: "open it in that program once more"
};

/// Throws InputError where the last changes to a database stand in a file beside it.
void refuse_unfinished_sqlite(const std::filesystem::path& file, const SqliteWords& words);
[[noreturn]] void refuse_as_unfinished(const std::filesystem::path& file, const SqliteWords& words,
                                       const std::string& what);

/// A database that can be read only, and asked only for what is in its tables: no views, triggers, functions
/// of the schema, virtual tables but R-trees, no other files.
class SqliteFile {
 public:
  /// Throws InputError at `file` for what is no database, or more than tables.
  SqliteFile(std::filesystem::path file, const SqliteWords& words);
  /// One that stands in memory, unpacked from `file`.
  SqliteFile(std::filesystem::path file, std::vector<std::uint8_t> bytes, const SqliteWords& words);

  /// An answer's row; a blob's bytes live until the next.
  class Row {
   public:
    explicit Row(sqlite3_stmt* statement) : statement_(statement) {}
    std::int64_t integer(int column) const;
    std::string text(int column) const;
    bool is_blob(int column) const;
    std::span<const std::uint8_t> blob(int column) const;

   private:
    sqlite3_stmt* statement_;
  };

  /// All rows of an answer to a SELECT, with numbers for its question marks. How many there are is for `use`
  /// to watch, which may throw. Throws InputError at a table or column that is not there, and at damage.
  void ask(const char* question, std::span<const std::int64_t> numbers,
           const std::function<void(const Row&)>& use) const;
  bool has_table(std::string_view name) const;
  /// Of the database: no table holds more.
  std::uintmax_t bytes() const { return bytes_; }
  const std::filesystem::path& path() const { return path_; }
  [[noreturn]] void fail(const std::string& what) const;

 private:
  /// `header`: its first bytes.
  void check_length(std::span<const std::uint8_t> header) const;
  void check_schema(const SqliteWords& words) const;

  std::filesystem::path path_;
  std::string kind_;
  std::uintmax_t bytes_ = 0;
  std::vector<std::uint8_t> memory_;
  std::unique_ptr<sqlite3, int (*)(sqlite3*)> database_;
};

}  // namespace tubefoot
