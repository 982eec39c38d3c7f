// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/column_names.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "files/words.hpp"

namespace tubefoot {
namespace {

constexpr std::size_t longest_name = 100;  // longer than any column name; keeps hostile input cheap

bool is_unit(std::string_view word) {
  constexpr std::array units{"deg", "degree", "degrees", "rad",   "radian", "radians", "grad",
                             "m",   "metre",  "metres",  "meter", "meters", "km",      "cm",
                             "mm",  "ft",     "feet",    "s",     "sec",    "second",  "seconds",
                             "ms",  "us",     "c",       "psu",   "ppt",    "db"};
  return std::ranges::find(units, word) != units.end();
}

/// Common names of quantities. Left: names in other programs; right: tubefoot's names. Both are results of
/// stem_of().
constexpr std::array<std::pair<std::string_view, std::string_view>, 13> same_quantity{
    {{"yaw", "heading"},
     {"hdg", "heading"},
     {"head", "heading"},
     {"lat", "latitude"},
     {"lon", "longitude"},
     {"lng", "longitude"},
     {"long", "longitude"},
     {"alt", "altitude"},
     {"speed", "soundspeed"},
     {"velocity", "soundspeed"},
     {"soundvelocity", "soundspeed"},
     {"temp", "temperature"},
     {"sal", "salinity"}}};

/// Returns the words of a name in lower case: "SoundSpeed [m/s]" gives sound, speed, m, s.
std::vector<std::string> words_of(std::string_view name) {
  const auto is_small = [](char c) { return c >= 'a' && c <= 'z'; };
  const auto is_capital = [](char c) { return c >= 'A' && c <= 'Z'; };
  std::vector<std::string> words;
  char before = 0;
  for (const char c : name) {
    if (is_small(c) || is_capital(c) || (c >= '0' && c <= '9')) {
      const bool inside = is_small(before) || is_capital(before) || (before >= '0' && before <= '9');
      if (!inside || (is_capital(c) && is_small(before))) words.emplace_back();
      words.back() += is_capital(c) ? static_cast<char>(c - 'A' + 'a') : c;
    }
    before = c;
  }
  return words;
}

/// Returns the quantity that a name denotes: the name without unit, capitals and separators.
std::string stem_of(std::string_view name) {
  std::vector<std::string> words = words_of(name);
  while (words.size() > 1 && is_unit(words.back())) words.pop_back();
  std::string stem;
  for (const std::string& word : words) stem += word;
  return stem;
}

/// Returns whether a name is a stem and a unit without a separator, as "headingrad" is.
bool is_with_unit(std::string_view name, std::string_view stem) {
  constexpr std::size_t shortest = 4;  // "ups" is not "up" in seconds
  return stem.size() >= shortest && name.starts_with(stem) && is_unit(name.substr(stem.size()));
}

bool is_slip(std::string_view name, std::string_view stem) {
  constexpr std::size_t shortest = 5, long_one = 9;  // too many shorter words are similar to each other
  const auto [less, more] = std::minmax({name.size(), stem.size()});
  if (less < shortest || more - less > 2 || name.front() != stem.front()) return false;
  return edit_distance(name, stem) <= (less >= long_one ? 2 : 1);
}

}  // namespace

std::string_view meant_column(std::string_view name, std::span<const std::string_view> columns) {
  if (name.size() > longest_name) return {};
  const std::string stem = stem_of(name);
  if (stem.empty()) return {};
  const auto same =
      std::ranges::find(same_quantity, stem, &std::pair<std::string_view, std::string_view>::first);
  const std::string_view quantity = same == same_quantity.end() ? std::string_view(stem) : same->second;
  for (const std::string_view column : columns) {
    const std::string known = stem_of(column);
    if (quantity == known || is_with_unit(stem, known)) return column;
  }
  for (const std::string_view column : columns)
    if (is_slip(stem, stem_of(column))) return column;
  return {};
}

}  // namespace tubefoot
