// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/file/toml_text.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <regex>

namespace tubefoot {
namespace {

/// Limits the dots in a line. toml++ nests a table for every dot of a key, and more than about 20000 dots
/// overflow the stack. Inside brackets it nests at most 256 deep, so that the dots of a line bound the
/// depth. Consecutive dots are text, not keys.
void check_dots(std::string_view text, const std::filesystem::path& file) {
  constexpr int most_dots = 64;
  SourcePlace place{file.string(), 1, 0};
  int dots = 0;
  char previous = '\n';
  for (const char c : text) {
    ++place.column;
    if (c == '\n') {
      ++place.line;
      place.column = dots = 0;
    } else if (c == '.' && previous != '.' && ++dots > most_dots) {
      throw InputError(place, fmt::format("the line has more than {} dots: break the line", most_dots));
    }
    previous = c;
  }
}

/// Returns a hint at the probable meaning of a line that is not TOML.
std::string toml_hint(std::string_view text, std::size_t number) {
  for (; number > 1 && text.find('\n') != text.npos; --number) text.remove_prefix(text.find('\n') + 1);
  const std::string line(text.substr(0, std::min<std::size_t>(text.find('\n'), 1000)));
  const auto is = [&](const char* form) { return std::regex_search(line, std::regex(form)); };
  if (is("^\\s*[A-Za-z0-9_-]+\\s*:")) return ": write key = value, with an equals sign";
  if (is("=\\s*[-+]?[0-9]+,[0-9]+\\s*(#.*)?$")) return ": write decimals with a point";
  if (is("=\\s*[-+]?[0-9.]+\\s*[A-Za-z%]"))
    return ": write only the number, because the key's name contains the unit";
  if (is("=\\s*[A-Za-z./~]")) return ": put text in quotes";
  if (is("\\\\")) return ": separate folders with /, because \\ starts an escape sequence";
  return "";
}

}  // namespace

toml::table parse_toml(std::string_view text, const TomlSource& source) {
  check_dots(text, source.file);
  try {
    return toml::parse(text);
  } catch (const toml::parse_error& error) {
    const SourcePlace place = source.place(error.source());
    throw InputError(place, fmt::format("not valid TOML: {}{}", error.description(),
                                        toml_hint(text, static_cast<std::size_t>(place.line))));
  }
}

}  // namespace tubefoot
