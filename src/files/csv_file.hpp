// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <istream>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "files/input_error.hpp"

namespace tubefoot {

/// One row of a CSV file: the values of the requested columns, in the order of the request. All values are
/// finite, except those of optional columns that the file lacks, which are NaN.
struct CsvRow {
  std::span<const double> values;
  std::span<const SourcePlace> places;  ///< place of each value; for a missing column, the header line
};

/// Reads the next line of a text, as std::getline() does. Throws InputError at `place` (of the line) for a
/// line longer than limits::line_bytes, before it reads the line: such a file is not a table.
bool next_line(std::istream& in, std::string& line, const SourcePlace& place);

/// Returns text as a cell of a CSV file, in quotes if necessary. Text that begins with =, +, -, @, a tab or
/// a line end gets a leading '. For spreadsheets it is then not a formula. Do not use it for numbers.
std::string csv_text(std::string_view text);

/// Contents of a CSV file in addition to the values of the requested columns.
struct CsvContents {
  std::size_t rows = 0;
  std::vector<std::string>
      ignored;  ///< names of the columns that were not requested, in the order of the file
};

/// Reads numbers from a CSV file and calls `take` for each row. The file has a header line that names
/// `columns` in any order. Blank lines and lines that start with # are skipped.
/// Further columns are ignored, except those that resemble a requested column that the file lacks
/// (meant_column()). Such a column is an error, as is a duplicate of a requested column. Throws InputError
/// "file:line:column: ...".
CsvContents read_csv(const std::filesystem::path& file, std::span<const std::string_view> columns,
                     const std::function<void(const CsvRow&)>& take);
/// Reads the same with optional columns, whose values follow the others in each row.
CsvContents read_csv(const std::filesystem::path& file, std::span<const std::string_view> columns,
                     std::span<const std::string_view> optional_columns,
                     const std::function<void(const CsvRow&)>& take);

/// Returns the warning "FILE: ignores the columns 'note', 'quality'", or nothing if there are no such
/// columns.
std::vector<std::string> ignored_columns_warning(const std::filesystem::path& file,
                                                 const CsvContents& contents);

}  // namespace tubefoot
