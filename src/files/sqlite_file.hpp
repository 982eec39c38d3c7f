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

// Opens untrusted databases. A schema is a program, and the number of rows may be endless.
namespace tubefoot {

/// Parts of the messages for rejected databases.
struct SqliteWords {
  std::string_view kind;     ///< "GeoPackage"
  std::string plain_tables;  ///< advice about views: "save its layers as plain tables with `ogr2ogr ...`"
  std::string finish;        ///< advice about changes in a separate file: "open it in that program once more"
};

/// Throws InputError if the last changes to a database are in a separate file.
void refuse_unfinished_sqlite(const std::filesystem::path& file, const SqliteWords& words);
[[noreturn]] void refuse_as_unfinished(const std::filesystem::path& file, const SqliteWords& words,
                                       const std::string& what);

/// A read-only database that answers only questions about its tables. Views, triggers, functions of the
/// schema, virtual tables except R-trees, and other files are not accessible.
class SqliteFile {
 public:
  /// Throws InputError at `file` if it is not a database, or contains more than tables.
  SqliteFile(std::filesystem::path file, const SqliteWords& words);
  /// Opens a database in memory that was decompressed from `file`.
  SqliteFile(std::filesystem::path file, std::vector<std::uint8_t> bytes, const SqliteWords& words);

  /// A row of an answer. The bytes of a blob are valid until the next row.
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

  /// Calls `use` with all rows of the answer to a SELECT. `numbers` replace its question marks. `use` must
  /// limit the number of rows and may throw. Throws InputError if a table or column is missing, or the file
  /// is damaged.
  void ask(const char* question, std::span<const std::int64_t> numbers,
           const std::function<void(const Row&)>& use) const;
  bool has_table(std::string_view name) const;
  /// Returns the size of the database, an upper bound of the size of each table.
  std::uintmax_t bytes() const { return bytes_; }
  const std::filesystem::path& path() const { return path_; }
  [[noreturn]] void fail(const std::string& what) const;

 private:
  /// `header` has the first bytes of the database.
  void check_length(std::span<const std::uint8_t> header) const;
  void check_schema(const SqliteWords& words) const;

  std::filesystem::path path_;
  std::string kind_;
  std::uintmax_t bytes_ = 0;
  std::vector<std::uint8_t> memory_;
  std::unique_ptr<sqlite3, int (*)(sqlite3*)> database_;
};

}  // namespace tubefoot
