// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/csv_file.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "files/inlet.hpp"
#include "files/limits.hpp"

namespace tubefoot {
namespace {

struct Field {
  std::string_view text;
  int column = 1;  // of its first character
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
    throw InputError(place, fmt::format("{} is '{}', expected a finite number", name, field.text));
  }
  return value;
}

class CsvReader {
 public:
  CsvReader(const std::filesystem::path& file, std::span<const std::string_view> columns,
            std::span<const std::string_view> optional_columns)
      : place_{file.string(), 0, 0}, columns_(columns), optional_columns_(optional_columns) {}

  std::size_t read(const std::function<void(const CsvRow&)>& take) {
    InputFile input(place_.file, place_);
    std::istream& in = input.stream();
    std::size_t rows = 0;
    for (std::string line; ++place_.line, next_line(in, line, place_);) {
      std::string_view text = line;
      if (place_.line == 1 && text.starts_with("\xEF\xBB\xBF"))
        text.remove_prefix(3);  // spreadsheets' UTF-8 mark
      const std::vector<Field> fields = fields_of(text);
      if ((fields.size() == 1 && fields[0].text.empty()) || fields[0].text.starts_with('#')) continue;
      if (header_size_ == 0) {
        read_header(fields);
      } else {
        if (++rows > limits::table_rows)
          throw InputError(place_, fmt::format("more than {} rows: thin out the table", limits::table_rows));
        read_row(fields, take);
      }
    }
    if (in.bad()) throw InputError(place_, "cannot be read to its end");
    if (header_size_ == 0) {
      throw InputError({place_.file, 0, 0}, fmt::format("is empty, expected the header line {}", wanted()));
    }
    return rows;
  }

 private:
  void read_header(const std::vector<Field>& fields) {
    header_size_ = fields.size();
    header_place_ = place_;
    const auto find = [&](std::string_view name) {
      const auto found = std::ranges::find(fields, name, &Field::text);
      return found == fields.end() ? no_field : static_cast<std::size_t>(found - fields.begin());
    };
    for (const std::string_view column : columns_) {
      field_of_column_.push_back(find(column));
      if (field_of_column_.back() == no_field)
        throw InputError(place_, fmt::format("the column {} is missing, expected the header {}", column,
                                             fmt::join(columns_, ",")));
    }
    for (const std::string_view column : optional_columns_) field_of_column_.push_back(find(column));
  }

  void read_row(const std::vector<Field>& fields, const std::function<void(const CsvRow&)>& take) {
    if (fields.size() != header_size_) {
      throw InputError(place_, fmt::format("the row has {} fields, expected {} as in the header",
                                           fields.size(), header_size_));
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

std::size_t read_csv(const std::filesystem::path& file, std::span<const std::string_view> columns,
                     const std::function<void(const CsvRow&)>& take) {
  return CsvReader(file, columns, {}).read(take);
}

std::size_t read_csv(const std::filesystem::path& file, std::span<const std::string_view> columns,
                     std::span<const std::string_view> optional_columns,
                     const std::function<void(const CsvRow&)>& take) {
  return CsvReader(file, columns, optional_columns).read(take);
}

}  // namespace tubefoot
