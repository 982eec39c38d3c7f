// SPDX-License-Identifier: GPL-3.0-or-later

// Splits a text mesh file into lines and words, and converts words to numbers with errors that name file,
// line and column.

#include "scene/meshes/mesh_file_text.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f'; }

// Returns the quotation of a word in a message: long enough to find it, without characters that affect a
// terminal.
std::string quoted(std::string_view word) {
  std::string text;
  for (const char c : word.substr(0, 40)) text += c >= ' ' && c <= '~' ? c : '?';
  return text;
}

// Removes a plus sign, which some programs write and std::from_chars rejects.
std::string_view without_plus(std::string_view text) {
  return text.size() > 1 && text[0] == '+' && text[1] != '-' ? text.substr(1) : text;
}

}  // namespace

TextLines::TextLines(std::string_view content, std::string file, bool joined)
    : content_(content), file_(std::move(file)), joined_(joined) {
  const std::size_t first = content.find_first_of("\r\n");
  if (first != content.npos && content[first] == '\r' && content.substr(first + 1, 1) != "\n")
    line_end_ = '\r';
}

bool TextLines::next() {
  if (next_ >= content_.size()) return false;
  stop_if_wanted();
  line_ += line_count_;
  line_count_ = 1;
  begin_ = at_ = next_;
  column_ = 1;
  for (end_ = begin_;; ++line_count_) {
    end_ = std::min(content_.find(line_end_, end_), content_.size());
    next_ = std::min(end_ + 1, content_.size());
    std::size_t last = end_;
    if (line_end_ == '\n' && last > begin_ && content_[last - 1] == '\r') --last;
    if (!joined_ || last == begin_ || content_[last - 1] != '\\' || next_ == content_.size()) return true;
    end_ = next_;
  }
}

void TextLines::next_with_words(std::string_view expected) {
  while (next()) {
    const std::size_t begin = at_;
    if (const std::string_view first = word(); !first.empty() && first[0] != '#') {
      at_ = begin;
      return;
    }
  }
  throw InputError({file_, line_, 0},
                   fmt::format("the file ends here, expected {}: it is cut off", expected));
}

std::string_view TextLines::word() {
  const auto skipped = [&](std::size_t i) {
    if (is_blank(content_[i])) return true;
    if (!joined_ || content_[i] != '\\') return false;
    const std::size_t after = i + (line_end_ == '\n' && i + 1 < end_ && content_[i + 1] == '\r' ? 2 : 1);
    return after == end_ || content_[after] == line_end_;
  };
  while (at_ < end_ && skipped(at_)) ++at_;
  const std::size_t first = at_;
  while (at_ < end_ && !skipped(at_)) ++at_;
  column_ = static_cast<int>(first - begin_) + 1;
  return content_.substr(first, at_ - first);
}

double TextLines::number(std::string_view what) {
  const std::string_view text = word();
  if (text.empty()) throw InputError(place(), fmt::format("{} is missing: the line is cut short", what));
  const std::string_view digits = without_plus(text);
  double value = 0;
  const auto [rest, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error == std::errc::result_out_of_range && rest == digits.data() + digits.size()) {
    // A value below the range of a double counts as zero. A value above the range is an error below.
    const std::size_t exponent = digits.find_first_of("eE");
    if (exponent != digits.npos && exponent + 1 < digits.size() && digits[exponent + 1] == '-') return 0.0;
  }
  if (error != std::errc() || rest != digits.data() + digits.size() || !std::isfinite(value)) {
    throw InputError(place(), fmt::format("{} is '{}', expected a finite number", what, quoted(text)));
  }
  return value;
}

void TextLines::skip(std::string_view what) {
  if (word().empty()) throw InputError(place(), fmt::format("{} is missing: the line is cut short", what));
}

std::int64_t TextLines::integer(std::string_view what) {
  const std::string_view text = word();
  if (text.empty()) throw InputError(place(), fmt::format("{} is missing: the line is cut short", what));
  return parse_integer(text, what);
}

std::int64_t TextLines::parse_integer(std::string_view text, std::string_view what) const {
  const std::string_view digits = without_plus(text);
  std::int64_t value = 0;
  const auto [rest, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || rest != digits.data() + digits.size()) {
    throw InputError(place(), fmt::format("{} is '{}', expected an integer", what, quoted(text)));
  }
  return value;
}

}  // namespace tubefoot
