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

/// One row of a CSV file: the values of the wanted columns, in the order they were asked for. All are finite,
/// but for those of optional columns that the file does not have: they are not numbers.
struct CsvRow {
  std::span<const double> values;
  std::span<const SourcePlace> places;  ///< of each value; of a missing column, the header line
};

/// The next line of a text, as std::getline() gives it. Throws InputError at `place` (the line's) for one
/// longer than limits::line_bytes, before it is read: such a file is no table.
bool next_line(std::istream& in, std::string& line, const SourcePlace& place);

/// A cell of a CSV file that holds text: in quotes where it needs them. Text that begins with =, +, -, @, a
/// tab or a line end has a ' before it, which tells spreadsheets that it is no formula. Not for numbers.
std::string csv_text(std::string_view text);

/// What a CSV file has besides the values of the wanted columns.
struct CsvContents {
  std::size_t rows = 0;
  std::vector<std::string> ignored;  ///< names of the columns that nobody wants, in the order of the file
};

/// Reads numbers from a CSV file: a header line that names `columns`, in any order, then rows, each handed to
/// `take`. Further columns are ignored, except those that resemble a wanted column that the file lacks
/// (meant_column()): they are an error, as is a wanted column that stands twice. Blank lines and lines that
/// start with # are skipped. Throws InputError "file:line:column: ...".
CsvContents read_csv(const std::filesystem::path& file, std::span<const std::string_view> columns,
                     const std::function<void(const CsvRow&)>& take);
/// The same with columns that may be missing, behind the others in each row.
CsvContents read_csv(const std::filesystem::path& file, std::span<const std::string_view> columns,
                     std::span<const std::string_view> optional_columns,
                     const std::function<void(const CsvRow&)>& take);

/// "FILE: ignores the columns 'note', 'quality'", as a warning; nothing where there are none.
std::vector<std::string> ignored_columns_warning(const std::filesystem::path& file,
                                                 const CsvContents& contents);

}  // namespace tubefoot
