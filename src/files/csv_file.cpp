// SPDX-License-Identifier: GPL-3.0-or-later

// Reads numbers from the named columns of a CSV file. Errors name line and column, and state what is
// probably wrong: another unit, another spelling of a column, a workbook, or another text encoding.

#include "files/csv_file.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "files/column_names.hpp"
#include "files/input_registry.hpp"
#include "files/limits.hpp"

namespace tubefoot {
namespace {

struct Field {
  std::string_view text;
  int column = 1;  // column of its first character
};

std::vector<Field> fields_of(std::string_view line) {
  constexpr std::string_view kBlanks = " \t\r";
  std::vector<Field> fields;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    std::size_t first = begin, last = end;
    while (first < last && kBlanks.find(line[first]) != kBlanks.npos) ++first;
    while (first < last && kBlanks.find(line[last - 1]) != kBlanks.npos) --last;
    fields.push_back({line.substr(first, last - first), static_cast<int>(first) + 1});
    begin = end + 1;
  }
  return fields;
}

double number(const Field& field, std::string_view name, const SourcePlace& place) {
  double value = 0;
  const char* end = field.text.data() + field.text.size();
  const auto [rest, error] = std::from_chars(field.text.data(), end, value);
  if (error != std::errc() || rest != end || !std::isfinite(value)) {
    const bool date = field.text.find(':') != field.text.npos;
    throw InputError(place, fmt::format("{} is '{}', expected a finite number{}", name, field.text,
                                        field.text.empty() ? ": the cell is empty"
                                        : date ? ": write seconds as one number, not a date or a time of day"
                                               : ""));
  }
  return value;
}

/// Returns a further column whose name differs from the wanted one only by its unit; empty if there is
/// none.
std::string_view in_other_units(const std::vector<Field>& fields, std::span<const std::string_view> columns,
                                std::string_view wanted) {
  constexpr std::array units{"rad", "deg", "grad", "m", "km", "cm", "mm", "ft", "s", "ms", "us", "min", "h"};
  const std::string_view stem = wanted.substr(0, wanted.rfind('_') + 1);  // "heading_"
  for (const Field& field : fields)
    if (!stem.empty() && field.text.starts_with(stem) &&
        std::ranges::find(units, field.text.substr(stem.size())) != units.end() &&
        std::ranges::find(columns, field.text) == columns.end())
      return field.text;
  return {};
}

/// Returns a hint at the probable error in the first line of a table.
std::string header_hint(std::string_view text, const std::vector<Field>& fields,
                        std::span<const std::string_view> columns, std::string_view wanted) {
  if (text.starts_with("PK") || text.starts_with("\xD0\xCF"))
    return ": this is a spreadsheet workbook: save it as CSV";
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF") || text.find('\0') != text.npos)
    return ": this is UTF-16 or not text: save it as CSV in UTF-8";
  for (const auto& [separator, name] :
       {std::pair(';', "semicolons"), std::pair('\t', "tabs"), std::pair(' ', "blanks")})
    if (fields.size() == 1 && text.find(separator) != text.npos)
      return fmt::format(
          ": the columns are separated by {}, expected commas between columns and points in decimal numbers",
          name);
  double value = 0;
  const std::string_view first = fields.front().text;
  if (std::from_chars(first.data(), first.data() + first.size(), value).ec == std::errc())
    return ": the first line holds numbers: put the header above it";
  if (const std::string_view other = in_other_units(fields, columns, wanted); !other.empty())
    return fmt::format(
        ": the name of the column '{}' has another unit: convert the column, and rename it to {}", other,
        wanted);
  for (const Field& field : fields)
    if (std::ranges::find(columns, field.text) == columns.end() &&
        !meant_column(field.text, {&wanted, 1}).empty())
      return fmt::format(": if the column '{}' holds it, rename that column to {}", field.text, wanted);
  std::vector<std::string_view> names;
  for (const Field& field : fields) names.push_back(field.text);
  return fmt::format(", not {}", fmt::join(names, ","));
}

class CsvReader {
 public:
  CsvReader(const std::filesystem::path& file, std::span<const std::string_view> columns,
            std::span<const std::string_view> optional_columns)
      : place_{file.string(), 0, 0}, columns_(columns), optional_columns_(optional_columns) {}

  CsvContents read(const std::function<void(const CsvRow&)>& take) {
    InputFile input(place_.file, place_);
    std::istream& in = input.stream();
    for (std::string line; ++place_.line, next_line(in, line, place_);) {
      std::string_view text = line;
      if (place_.line == 1 && text.starts_with("\xEF\xBB\xBF"))
        text.remove_prefix(3);  // byte order mark of UTF-8, which spreadsheets write
      const std::vector<Field> fields = fields_of(text);
      if ((fields.size() == 1 && fields[0].text.empty()) || fields[0].text.starts_with('#')) continue;
      if (header_size_ == 0) {
        read_header(text, fields);
      } else {
        if (++contents_.rows > limits::table_rows)
          throw InputError(place_,
                           fmt::format("the table has more than {} rows: thin it out", limits::table_rows));
        read_row(fields, take);
      }
    }
    if (in.bad()) throw InputError(place_, "cannot be read to the end");
    if (header_size_ == 0) {
      throw InputError({place_.file, 0, 0}, fmt::format("is empty, expected the header line {}", wanted()));
    }
    return std::move(contents_);
  }

 private:
  void read_header(std::string_view text, const std::vector<Field>& fields) {
    header_size_ = fields.size();
    header_place_ = place_;
    const auto find = [&](std::string_view name) {
      const auto found = std::ranges::find(fields, name, &Field::text);
      return found == fields.end() ? no_field : static_cast<std::size_t>(found - fields.begin());
    };
    for (const std::string_view column : columns_) {
      field_of_column_.push_back(find(column));
      if (field_of_column_.back() == no_field)
        throw InputError(place_,
                         fmt::format("the column {} is missing, expected the header {}{}", column,
                                     fmt::join(columns_, ","), header_hint(text, fields, columns_, column)));
    }
    bool has_optional = false;
    std::vector<std::string_view> lacking;
    for (const std::string_view column : optional_columns_) {
      field_of_column_.push_back(find(column));
      if (field_of_column_.back() != no_field) {
        has_optional = true;
        continue;
      }
      lacking.push_back(column);
      if (const std::string_view other = in_other_units(fields, optional_columns_, column); !other.empty()) {
        throw InputError(
            place_,
            fmt::format(
                "the name of the column '{}' has another unit: convert the column, and rename it to {}",
                other, column));
      }
    }
    read_further(fields, lacking);
    if (columns_.empty() && !has_optional)
      throw InputError(place_,
                       fmt::format("none of the expected columns is present, expected some of {}{}", wanted(),
                                   header_hint(text, fields, optional_columns_, optional_columns_.front())));
  }

  /// Records the columns that were not requested. `lacking` are requested columns that the file does not
  /// have.
  void read_further(const std::vector<Field>& fields, std::span<const std::string_view> lacking) {
    for (const Field& field : fields)
      if (field.text.find('\0') != field.text.npos)
        throw InputError(
            {place_.file, place_.line, field.column},
            fmt::format("the column names are not text{}", header_hint(field.text, fields, columns_, "")));
    for (std::size_t k = 0; k < fields.size(); ++k) {
      if (std::ranges::find(field_of_column_, k) != field_of_column_.end()) continue;
      const Field& field = fields[k];
      const SourcePlace place{place_.file, place_.line, field.column};
      for (const std::span<const std::string_view> some : {columns_, optional_columns_})
        if (std::ranges::find(some, field.text) != some.end())
          throw InputError(
              place,
              fmt::format("the column {} occurs twice, expected it once: remove one of the two", field.text));
      if (const std::string_view meant = meant_column(field.text, lacking); !meant.empty())
        throw InputError(
            place, fmt::format("unknown column '{}': did you mean '{}'? Rename the column, or remove it",
                               field.text, meant));
      if (!field.text.empty()) contents_.ignored.emplace_back(field.text);
    }
  }

  void read_row(const std::vector<Field>& fields, const std::function<void(const CsvRow&)>& take) {
    if (fields.size() != header_size_) {
      throw InputError(
          place_,
          fmt::format("the row has {} fields, expected {} as in the header{}", fields.size(), header_size_,
                      fields.size() > header_size_ ? ": are decimals written with commas? Use points" : ""));
    }
    std::vector<double> values;
    std::vector<SourcePlace> places;
    for (std::size_t i = 0; i < field_of_column_.size(); ++i) {
      if (field_of_column_[i] == no_field) {
        places.push_back(header_place_);
        values.push_back(std::numeric_limits<double>::quiet_NaN());
        continue;
      }
      const Field& field = fields[field_of_column_[i]];
      places.push_back({place_.file, place_.line, field.column});
      values.push_back(number(
          field, i < columns_.size() ? columns_[i] : optional_columns_[i - columns_.size()], places.back()));
    }
    take({values, places});
  }

  std::string wanted() const {
    return fmt::format("{}{}{}", fmt::join(columns_, ","),
                       columns_.empty() || optional_columns_.empty() ? "" : ",",
                       fmt::join(optional_columns_, ","));
  }

  static constexpr std::size_t no_field = std::numeric_limits<std::size_t>::max();
  SourcePlace place_, header_place_;
  std::span<const std::string_view> columns_, optional_columns_;
  std::size_t header_size_ = 0;
  std::vector<std::size_t> field_of_column_;
  CsvContents contents_;
};

}  // namespace

std::string csv_text(std::string_view text) {
  const bool formula = text.find_first_of("=+-@\t\r\n") == 0;
  if (!formula && text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
  std::string cell = formula ? "\"'" : "\"";
  for (const char c : text) {
    if (c == '"') cell += '"';
    cell += c;
  }
  return cell + '"';
}

bool next_line(std::istream& in, std::string& line, const SourcePlace& place) {
  line.clear();
  for (char c; in.get(c);) {
    if (c == '\n') return true;
    if (line.size() == limits::line_bytes)
      throw InputError(place, fmt::format("the line is longer than {} bytes, expected a table of text",
                                          limits::line_bytes));
    line += c;
  }
  return !line.empty();
}

CsvContents read_csv(const std::filesystem::path& file, std::span<const std::string_view> columns,
                     const std::function<void(const CsvRow&)>& take) {
  return CsvReader(file, columns, {}).read(take);
}

CsvContents read_csv(const std::filesystem::path& file, std::span<const std::string_view> columns,
                     std::span<const std::string_view> optional_columns,
                     const std::function<void(const CsvRow&)>& take) {
  return CsvReader(file, columns, optional_columns).read(take);
}

std::vector<std::string> ignored_columns_warning(const std::filesystem::path& file,
                                                 const CsvContents& contents) {
  constexpr std::size_t most = 30;
  const std::vector<std::string>& names = contents.ignored;
  if (names.empty()) return {};
  const std::span<const std::string> listed = std::span(names).first(std::min(most, names.size()));
  return {fmt::format("{}: tubefoot ignores the column{} '{}'{}", file.string(), names.size() == 1 ? "" : "s",
                      fmt::join(listed, "', '"),
                      names.size() > most ? fmt::format(" and {} others", names.size() - most) : "")};
}

}  // namespace tubefoot
