// SPDX-License-Identifier: GPL-3.0-or-later

// Replaces control characters, bidirectional marks and invalid UTF-8 by escapes, and shortens long text.
// Text of untrusted files is then safe on terminals, pages and drawings.

#include "files/shown.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

namespace tubefoot {
namespace {

/// A character and its number of bytes; 0 bytes if no valid UTF-8 begins here.
struct Character {
  char32_t code = 0;
  std::size_t bytes = 0;
};

Character first_of(std::string_view text) {
  const auto byte = [text](std::size_t k) -> unsigned { return static_cast<unsigned char>(text[k]); };
  const unsigned lead = byte(0);
  if (lead < 0x80) return {lead, 1};
  const std::size_t bytes = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
  if (lead < 0xc2 || lead > 0xf4 || text.size() < bytes) return {};
  char32_t code = lead & (0xffu >> (bytes + 1));
  for (std::size_t k = 1; k < bytes; ++k) {
    if ((byte(k) & 0xc0u) != 0x80u) return {};
    code = code << 6 | (byte(k) & 0x3fu);
  }
  // Rejects overlong sequences, surrogates, and codes beyond U+10FFFF.
  constexpr char32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
  if (code < least[bytes] || (code >= 0xd800 && code < 0xe000) || code > 0x10ffff) return {};
  return {code, bytes};
}

bool is_control(char32_t code) { return code < 0x20 || (code >= 0x7f && code < 0xa0); }

/// Returns whether a character is a bidirectional mark, or a separator of lines or paragraphs.
bool turns_text(char32_t code) {
  return (code >= 0x202a && code <= 0x202e) || (code >= 0x2066 && code <= 0x2069) || code == 0x200e ||
         code == 0x200f || code == 0x061c || code == 0x2028 || code == 0x2029;
}

void append_harmless(std::string_view text, bool one_line, std::string& out) {
  for (std::size_t at = 0; at < text.size();) {
    const Character c = first_of(text.substr(at));
    if (c.bytes == 0) {
      out += fmt::format("\\x{:02x}", static_cast<unsigned char>(text[at]));
      ++at;
      continue;
    }
    if ((c.code == '\n' || c.code == '\t') && !one_line)
      out += static_cast<char>(c.code);
    else if (c.code < 0x80 && is_control(c.code))
      out += fmt::format("\\x{:02x}", static_cast<unsigned>(c.code));
    else if (is_control(c.code) || turns_text(c.code))
      out += fmt::format("\\u{:04x}", static_cast<unsigned>(c.code));
    else
      out += text.substr(at, c.bytes);
    at += c.bytes;
  }
}

/// Returns whether a position lies within a character of several bytes.
bool within(std::string_view text, std::size_t at) {
  return (static_cast<unsigned char>(text[at]) & 0xc0) == 0x80;
}

}  // namespace

std::string harmless(std::string_view text) {
  // Most text consists only of printable ASCII characters.
  if (std::all_of(text.begin(), text.end(), [](char c) { return (c >= ' ' && c <= '~') || c == '\n'; }))
    return std::string(text);
  std::string result;
  append_harmless(text, false, result);
  return result;
}

std::string shown(std::string_view text) {
  constexpr std::size_t longest = 4000, kept = longest / 2;
  if (text.size() <= longest) return harmless(text);
  std::size_t begin = kept, end = text.size() - kept;
  while (begin > kept - 4 && within(text, begin)) --begin;
  while (end < text.size() - kept + 4 && within(text, end)) ++end;
  return harmless(text.substr(0, begin)) + fmt::format(" [{} characters] ", end - begin) +
         harmless(text.substr(end));
}

std::string shown_line(std::string_view text) {
  constexpr std::size_t longest = 200;
  std::size_t end = text.size();
  if (end > longest)
    for (end = longest; end > longest - 4 && within(text, end);) --end;
  std::string result;
  append_harmless(text.substr(0, end), true, result);
  if (end < text.size()) result += "...";
  return result;
}

std::string shown_markup(std::string_view text) {
  std::string result;
  for (const char c : harmless(text))
    if (c == '&')
      result += "&amp;";
    else if (c == '<')
      result += "&lt;";
    else if (c == '>')
      result += "&gt;";
    else if (c == '"')
      result += "&quot;";
    else
      result += c;
  return result;
}

}  // namespace tubefoot
