// SPDX-License-Identifier: GPL-3.0-or-later
// Reads NPY files of NumPy: a header with a Python literal (type, order and shape), then the values.
// Format: https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html
#include "import/frames/npy_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "files/memory_at_hand.hpp"
#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

using namespace std::string_view_literals;

constexpr std::string_view magic = "\x93NUMPY"sv;
constexpr std::size_t longest_header = 1 << 16, most_axes = 8;

/// Contents of the Python literal in the header.
struct Header {
  std::string type;
  bool fortran_order = false;
  std::vector<std::size_t> shape;
};

/// Parses the literal, a dictionary with exactly the three keys that NumPy writes.
class HeaderText {
 public:
  HeaderText(std::string_view text, const SourcePlace& place) : text_(text), place_(place) {}

  Header read() {
    Header header;
    bool type = false, order = false, shape = false;
    expect('{');
    while (!take('}')) {
      const std::string key = quoted();
      expect(':');
      if (key == "descr" && !type) {
        if (peek() == '[') fail("has fields of several types: write one array of plain numbers");
        header.type = quoted();
        type = true;
      } else if (key == "fortran_order" && !order) {
        header.fortran_order = word() == "True";
        order = true;
      } else if (key == "shape" && !shape) {
        header.shape = tuple();
        shape = true;
      } else {
        fail(fmt::format("has the key '{}' in its header, which NumPy does not write", key));
      }
      if (!take(',') && peek() != '}') fail("has a header that is cut off or damaged");
    }
    if (!type || !order || !shape) fail("has a header without 'descr', 'fortran_order' or 'shape'");
    return header;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw InputError(place_, "the NPY file " + what); }
  char peek() {
    while (at_ < text_.size() && std::strchr(" \t\r\n", text_[at_]) && text_[at_] != '\0') ++at_;
    return at_ < text_.size() ? text_[at_] : '\0';
  }
  bool take(char c) {
    if (peek() != c) return false;
    ++at_;
    return true;
  }
  void expect(char c) {
    if (!take(c)) fail("has a header that is cut off or damaged");
  }
  std::string quoted() {
    const char quote = peek();
    if (quote != '\'' && quote != '"') fail("has a header that is cut off or damaged");
    const std::size_t end = text_.find(quote, ++at_);
    if (end == text_.npos) fail("has a header that is cut off or damaged");
    const std::string word(text_.substr(at_, end - at_));
    at_ = end + 1;
    return word;
  }
  std::string_view word() {
    peek();
    for (const std::string_view known : {"True"sv, "False"sv})
      if (text_.substr(at_).starts_with(known)) {
        at_ += known.size();
        return known;
      }
    fail("has a 'fortran_order' that is neither True nor False");
  }
  std::vector<std::size_t> tuple() {
    std::vector<std::size_t> values;
    expect('(');
    while (!take(')')) {
      peek();
      std::size_t value = 0;
      const char *first = text_.data() + at_, *last = text_.data() + text_.size();
      const auto [end, error] = std::from_chars(first, last, value);
      if (error != std::errc{}) fail("has a 'shape' that is not a list of lengths");
      at_ += static_cast<std::size_t>(end - first);
      take('L');  // Python 2 writes an L after long integers
      values.push_back(value);
      if (values.size() > most_axes) fail(fmt::format("has more than {} axes", most_axes));
      if (!take(',') && peek() != ')') fail("has a 'shape' that is not a list of lengths");
    }
    return values;
  }

  std::string_view text_;
  SourcePlace place_;
  std::size_t at_ = 0;
};

template <class Stored>
Stored stored_at(const char* bytes, bool swapped) {
  std::array<char, sizeof(Stored)> own;
  std::memcpy(own.data(), bytes, own.size());
  if (swapped) std::ranges::reverse(own);
  return std::bit_cast<Stored>(own);
}

/// Converts IEEE 754 binary16 to double.
double half(std::uint16_t bits) {
  const int exponent = bits >> 10 & 31;
  const double fraction = bits & 1023, sign = bits >> 15 ? -1 : 1;
  if (exponent == 31) return fraction == 0 ? sign * INFINITY : NAN;
  return sign * (exponent == 0 ? std::ldexp(fraction, -24) : std::ldexp(fraction + 1024, exponent - 25));
}

using Reader = double (*)(const char*, bool);

template <class Stored>
double real(const char* bytes, bool swapped) {
  return static_cast<double>(stored_at<Stored>(bytes, swapped));
}
template <class Stored>
double magnitude(const char* bytes, bool swapped) {
  return std::hypot(stored_at<Stored>(bytes, swapped), stored_at<Stored>(bytes + sizeof(Stored), swapped));
}

struct NumberType {
  std::string_view word;
  std::size_t bytes;
  Reader read;
};

constexpr NumberType number_types[] = {
    {"b1", 1, real<std::uint8_t>},
    {"i1", 1, real<std::int8_t>},
    {"u1", 1, real<std::uint8_t>},
    {"i2", 2, real<std::int16_t>},
    {"u2", 2, real<std::uint16_t>},
    {"i4", 4, real<std::int32_t>},
    {"u4", 4, real<std::uint32_t>},
    {"i8", 8, real<std::int64_t>},
    {"u8", 8, real<std::uint64_t>},
    {"f2", 2, [](const char* bytes, bool swapped) { return half(stored_at<std::uint16_t>(bytes, swapped)); }},
    {"f4", 4, real<float>},
    {"f8", 8, real<double>},
    {"c8", 8, magnitude<float>},
    {"c16", 16, magnitude<double>}};

const NumberType& type_of(const std::string& descr, const SourcePlace& place) {
  const std::string_view word =
      std::string_view(descr).substr(!descr.empty() && std::strchr("<>=|", descr[0]) ? 1 : 0);
  if (word.starts_with('O'))
    throw InputError(place,
                     "the NPY file contains Python objects, which tubefoot does not read because it would "
                     "have to run them: write plain numbers (array.astype(float))");
  const auto found = std::ranges::find(number_types, word, &NumberType::word);
  if (found == std::end(number_types))
    throw InputError(place, fmt::format("the NPY file has numbers of type '{}', which tubefoot does not "
                                        "read: write float64, float32 or uint8",
                                        descr));
  return *found;
}

/// Reorders values of Fortran order, in which the first axis varies fastest.
std::vector<double> last_axis_fastest(const std::vector<std::size_t>& shape,
                                      const std::vector<double>& values) {
  std::vector<double> turned(values.size());
  std::vector<std::size_t> place(shape.size(), 0);
  for (const double value : values) {
    std::size_t index = 0;
    for (std::size_t axis = 0; axis < shape.size(); ++axis) index = index * shape[axis] + place[axis];
    turned[index] = value;
    for (std::size_t axis = 0; axis < shape.size(); ++axis) {
      if (++place[axis] < shape[axis]) break;
      place[axis] = 0;
    }
  }
  return turned;
}

}  // namespace

NumberArray read_npy(std::string_view bytes, const SourcePlace& place) {
  const auto cut_off = [&]() -> InputError {
    return {place, "the NPY file is cut off or damaged: write it again"};
  };
  if (!bytes.starts_with(magic)) throw InputError(place, "is not an NPY file (it does not begin like one)");
  if (bytes.size() < 10) throw cut_off();
  const int version = bytes[6];
  if (version < 1 || version > 3)
    throw InputError(place, fmt::format("has version {} of the NPY format, expected 1 to 3", version));
  const std::size_t begin = version == 1 ? 10 : 12;
  if (bytes.size() < begin) throw cut_off();
  constexpr bool swapped_here = std::endian::native == std::endian::big;
  const std::size_t length = version == 1 ? stored_at<std::uint16_t>(&bytes[8], swapped_here)
                                          : stored_at<std::uint32_t>(&bytes[8], swapped_here);
  if (length > longest_header) throw InputError(place, "the header of the NPY file is too long");
  if (bytes.size() < begin + length) throw cut_off();
  const Header header = HeaderText(bytes.substr(begin, length), place).read();
  const NumberType& type = type_of(header.type, place);
  const std::string_view data = bytes.substr(begin + length);
  const std::size_t count = counted(header.shape, place);
  if (count > data.size() / type.bytes || count * type.bytes != data.size())
    throw InputError(place, fmt::format("the NPY file declares {} values of {} bytes, but has {} bytes of "
                                        "data: it is cut off or damaged; write it again",
                                        fmt::join(header.shape, " x "), type.bytes, data.size()));
  require_memory(2.0 * sizeof(double) * static_cast<double>(count), place, "its values",
                 "write fewer values per file");
  const bool swapped = header.type[0] == '>' ? std::endian::native == std::endian::little : swapped_here;
  NumberArray array{"", header.shape, std::vector<double>(count), type.word == "u1"};
  for (std::size_t k = 0; k < count; ++k) {
    if (k % (1 << 20) == 0) stop_if_wanted();
    array.values[k] = type.read(&data[k * type.bytes], swapped);
  }
  if (header.fortran_order) array.values = last_axis_fastest(array.shape, array.values);
  return array;
}

}  // namespace tubefoot
