// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/input_error.hpp"

#include <fmt/format.h>

namespace tubefoot {

std::string to_string(const SourcePlace& place) {
  if (place.line <= 0) return place.file;
  if (place.column <= 0) return fmt::format("{}:{}", place.file, place.line);
  return fmt::format("{}:{}:{}", place.file, place.line, place.column);
}

std::string shown(std::string_view text) {
  constexpr std::size_t longest = 4000, kept = longest / 2;
  std::string result;
  const auto show = [&result](std::string_view part) {
    for (const char c : part) {
      const auto code = static_cast<unsigned char>(c);
      if ((code < 0x20 && c != '\n' && c != '\t') || code == 0x7f)
        result += fmt::format("\\x{:02x}", code);
      else
        result += c;
    }
  };
  if (text.size() <= longest) {
    show(text);
    return result;
  }
  // Not through a character of several bytes (UTF-8).
  const auto within = [text](std::size_t at) {
    return (static_cast<unsigned char>(text[at]) & 0xc0) == 0x80;
  };
  std::size_t begin = kept, end = text.size() - kept;
  while (begin > kept - 4 && within(begin)) --begin;
  while (end < text.size() - kept + 4 && within(end)) ++end;
  show(text.substr(0, begin));
  result += fmt::format(" [{} characters] ", end - begin);
  show(text.substr(end));
  return result;
}

InputError::InputError(const SourcePlace& where, const std::string& message)
    : std::runtime_error(shown(to_string(where) + ": " + message)), place(where) {}

}  // namespace tubefoot
