// SPDX-License-Identifier: GPL-3.0-or-later
// Reads a matrix of real or complex numbers from text. Commas, semicolons, tabs or blanks separate the
// numbers of a row. It also accepts the complex numbers of DAVE, which may lack the sign of a zero
// imaginary part.
#include "import/frames/csv_frames.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <string_view>

#include "files/csv_file.hpp"
#include "files/input_registry.hpp"
#include "files/limits.hpp"
#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

constexpr std::string_view blanks = " \t\r";

/// Removes a number from the beginning of a text; a plus sign may precede it.
bool take_number(std::string_view& text, double& value) {
  std::string_view rest = text;
  if (rest.starts_with('+')) rest.remove_prefix(1);
  const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
  if (error != std::errc{}) return false;
  text = rest.substr(static_cast<std::size_t>(end - rest.data()));
  return true;
}

/// Parses "1.5", or "1.5-2.5i" and "1.5-2.5j" as their magnitudes. Some C++ programs write both parts one
/// after the other and write a plus sign only for a positive imaginary part. A zero imaginary part then
/// results in "1.50i". Its last 0 is the imaginary part.
bool number_in(std::string_view text, double& value, bool& complex) {
  if (!text.empty() && (text.back() == 'i' || text.back() == 'j')) {
    complex = true;
    text.remove_suffix(1);
    double real = 0, imaginary = 0;
    if (!take_number(text, real)) return false;
    if (text.empty()) return false;
    if (!take_number(text, imaginary) || !text.empty()) return false;
    value = std::hypot(real, imaginary);
    return std::isfinite(value);
  }
  return take_number(text, value) && text.empty() && std::isfinite(value);
}

bool without_sign(std::string_view text) {
  const std::size_t at = text.find_last_of("+-");
  return at == text.npos || at == 0 || text[at - 1] == 'e' || text[at - 1] == 'E';
}

class Matrix {
 public:
  explicit Matrix(const std::filesystem::path& file) : file_(file), input_(file) {}

  ForeignData read() {
    std::string line;
    for (place_ = {file_.string(), 1, 0}; next_line(input_.stream(), line, place_); ++place_.line) row(line);
    if (frame_.rows == 0) throw InputError({file_.string()}, "contains no numbers");
    ForeignData data{{std::move(frame_)}, {}};
    if (ranges_) data.noticed.emplace_back("the first column is the range of each row");
    if (complex_)
      data.noticed.emplace_back("the numbers are complex: their magnitudes are read as amplitudes");
    return data;
  }

 private:
  void row(std::string_view line) {
    if (frame_.rows % 64 == 0) stop_if_wanted();
    const std::size_t first = line.find_first_not_of(blanks);
    if (first == line.npos) return;
    if (line[first] == '#') {
      ranges_ = ranges_ || line.find("First column is range") != line.npos;
      return;
    }
    const char separator = separator_of(line);
    std::size_t columns = 0;
    for (std::size_t begin = 0; begin <= line.size();) {
      if (separator == ' ') begin = std::min(line.find_first_not_of(blanks, begin), line.size());
      const std::size_t end = std::min(
          separator == ' ' ? line.find_first_of(blanks, begin) : line.find(separator, begin), line.size());
      if (separator == ' ' && begin == line.size()) break;
      value(line.substr(begin, end - begin), begin, columns++);
      begin = end + 1;
    }
    const std::size_t values = columns - (ranges_ ? 1 : 0);
    if (frame_.rows == 0) frame_.columns = values;
    if (values != frame_.columns || values == 0)
      throw InputError(place_,
                       fmt::format("has {} values, but the first row has {}", values, frame_.columns));
    ++frame_.rows;
  }

  static char separator_of(std::string_view line) {
    for (const char one : {',', ';', '\t'})
      if (line.find(one) != line.npos) return one;
    return ' ';
  }

  void value(std::string_view text, std::size_t begin, std::size_t column) {
    const std::size_t first = text.find_first_not_of(blanks);
    const std::size_t last = text.find_last_not_of(blanks);
    const SourcePlace place{place_.file, place_.line,
                            static_cast<int>(begin + (first == text.npos ? 0 : first)) + 1};
    if (first != text.npos) text = text.substr(first, last - first + 1);
    double number = 0;
    bool good = false;
    if (text.size() > 2 && text.ends_with("0i") && without_sign(text)) {
      complex_ = true;
      text.remove_suffix(2);
      good = take_number(text, number) && text.empty() && std::isfinite(number);
      number = std::abs(number);
    } else {
      good = number_in(text, number, complex_);
    }
    if (!good)
      throw InputError(
          place, fmt::format(
                     "'{}' is not a finite number: a picture is a matrix of numbers, with one row per line{}",
                     text, frame_.rows == 0 ? "; begin a header line with #" : ""));
    if (ranges_ && column == 0) {
      frame_.range_m.push_back(number);
      return;
    }
    if (frame_.values.size() == static_cast<std::size_t>(limits::ping_cells))
      throw InputError(
          place, fmt::format("the picture has more values than a ping can hold ({})", limits::ping_cells));
    frame_.values.push_back(number);
  }

  std::filesystem::path file_;
  InputFile input_;
  bool ranges_ = false, complex_ = false;
  SourcePlace place_;
  ForeignFrame frame_;
};

}  // namespace

ForeignData read_matrix(const std::filesystem::path& file) { return Matrix(file).read(); }

}  // namespace tubefoot
