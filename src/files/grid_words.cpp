// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/grid_words.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>

namespace tubefoot {
namespace {

using namespace std::string_view_literals;

// The keywords are so long that they do not occur by chance.
constexpr std::array
    words{"proj4_grids"sv, "parameterfile"sv, "nadgrids"sv, "geoidgrids"sv,
          "gridshift"sv,   "defmodel"sv,      "tinshift"sv, "proj=deformation"sv,
          "boundcrs\""sv,  "boundcrs&quot;"sv};  // in PROJJSON, where any value may be a file
constexpr std::size_t longest = 24;              // length of the longest keyword and the characters after it

/// Returns whether the keyword names no file, as in Web Mercator.
bool is_none(std::string_view behind) {
  return behind.starts_with("nadgrids=@null") && (behind.size() == 14 || behind[14] != ',');
}

}  // namespace

void GridWords::feed(std::string_view piece) {
  if (!met_.empty()) return;
  // Sparse files consist mostly of such pieces.
  if (std::ranges::all_of(piece, [](char c) { return c == '\0'; })) {
    tail_.clear();
    return;
  }
  tail_.reserve(tail_.size() + piece.size());
  for (const char c : piece) tail_ += c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
  for (const std::string_view word : words)
    for (std::size_t at = tail_.find(word); at != tail_.npos; at = tail_.find(word, at + 1))
      // At the very end, the characters after the keyword are not known yet. The next piece decides, or the
      // keyword counts.
      if (!is_none(std::string_view(tail_).substr(at))) met_ = word;
  if (tail_.size() > longest) tail_.erase(0, tail_.size() - longest);
}

std::string names_grids(std::string_view named) {
  return fmt::format(
      "has a coordinate reference system that refers to correction files ('{}'), which tubefoot does not "
      "read: write a copy with another coordinate reference system by `gdal_translate -a_srs EPSG:... IN "
      "OUT` for rasters or `ogr2ogr -a_srs EPSG:... OUT IN` for vectors",
      named);
}

}  // namespace tubefoot
