// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstring>
#include <limits>

#include "geometry/steps/stop.hpp"
#include "scene/meshes/mesh_file_polygons.hpp"
#include "scene/meshes/mesh_file_text.hpp"

// Reads Stereolithography (STL): facets with three vertices of their own. The format is text, or binary
// with 80 bytes of comment, a count of 32 bits and 50 bytes per facet, little-endian. Equal vertices are
// merged later, on the world grid.
namespace tubefoot {
namespace {

constexpr std::size_t kHeaderBytes = 84, kFacetBytes = 50;
static_assert(std::endian::native == std::endian::little, "binary STL is copied as it is");

std::uint64_t facets_announced(std::string_view content) {
  std::uint32_t facets = 0;
  std::memcpy(&facets, content.data() + 80, sizeof facets);
  return facets;
}

/// Returns a word in lower case, because some writers use capitals.
std::string small(std::string_view word) {
  std::string text(word);
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return text;
}

// Many binary files begin with "solid" as well. The length decides, then bytes that no text contains.
bool is_binary(std::string_view content) {
  if (content.size() >= kHeaderBytes &&
      content.size() == kHeaderBytes + kFacetBytes * facets_announced(content)) {
    return true;
  }
  const std::size_t first = std::min(content.find_first_not_of(" \t\r\n"), content.size());
  return small(content.substr(first, 5)) != "solid" || content.substr(0, 1024).find('\0') != content.npos;
}

void add_triangle(UncheckedPolygons& polygons) {
  const auto corners = static_cast<std::uint32_t>(polygons.corners.size());
  for (std::uint32_t k = 0; k < 3; ++k) polygons.corners.push_back(corners + k);
  polygons.end_polygon();
}

UncheckedPolygons parse_binary(std::string_view content, const std::string& file) {
  if (content.size() < kHeaderBytes) {
    throw InputError(
        {file, 0, 0},
        fmt::format("is not an STL or is cut off: it has {} bytes, but a binary STL has at least {}",
                    content.size(), kHeaderBytes));
  }
  const std::uint64_t facets = facets_announced(content);
  const std::uint64_t needed = kHeaderBytes + kFacetBytes * facets;
  if (content.size() < needed) {
    throw InputError(
        {file, 0, 0},
        fmt::format(
            "is not an STL or is cut off: its header declares {} facets in {} bytes, but the file has {}",
            facets, needed, content.size()));
  }
  if (3 * facets > std::numeric_limits<std::uint32_t>::max()) {
    throw InputError({file, 0, 0}, fmt::format("holds {} facets, more than 2^32 / 3", facets));
  }
  UncheckedPolygons polygons;
  if (content.size() > needed) {
    polygons.warnings.push_back(
        fmt::format("{}: {} bytes after the last facet are ignored", file, content.size() - needed));
  }
  polygons.points.reserve(3 * facets);
  for (std::uint64_t facet = 0; facet < facets; ++facet) {
    stop_if_wanted();
    float v[9];
    std::memcpy(v, content.data() + kHeaderBytes + kFacetBytes * facet + 12, sizeof v);  // after the normal
    for (const float coordinate : v) {
      if (!std::isfinite(coordinate)) {
        throw InputError({file, 0, 0},
                         fmt::format("facet {} (counted from 0) has a coordinate that is {}, expected "
                                     "finite numbers",
                                     facet, coordinate));
      }
    }
    for (int k = 0; k < 9; k += 3) polygons.points.emplace_back(v[k], v[k + 1], v[k + 2]);
    add_triangle(polygons);
  }
  return polygons;
}

void expect(TextLines& text, std::string_view expected) {
  if (small(text.word()) != expected) throw InputError(text.place(), fmt::format("expected '{}'", expected));
}

/// Returns the next word, and joins "end solid" to "endsolid" and similar pairs.
std::string word_or_end(TextLines& text) {
  std::string word = small(text.word());
  if (word == "end") word += small(text.word());
  return word;
}

UncheckedPolygons parse_text(std::string_view content, const std::string& file) {
  UncheckedPolygons polygons;
  TextLines text(content, file);
  bool in_solid = false;
  for (;;) {
    if (!in_solid) {
      // Several solids may follow each other.
      if (text.rest().find_first_not_of(" \t\r\n") == std::string_view::npos) return polygons;
      text.next_with_words("'solid'");
      expect(text, "solid");
      in_solid = true;
      continue;
    }
    text.next_with_words("'facet' or 'endsolid'");
    const std::string keyword = word_or_end(text);
    if (keyword == "endsolid") {
      in_solid = false;
      continue;
    }
    if (keyword != "facet") throw InputError(text.place(), "expected 'facet' or 'endsolid'");
    text.next_with_words("'outer loop'");
    expect(text, "outer");
    expect(text, "loop");
    for (int k = 0; k < 3; ++k) {
      text.next_with_words("'vertex'");
      expect(text, "vertex");
      const double x = text.number("the vertex's x"), y = text.number("the vertex's y");
      polygons.points.emplace_back(x, y, text.number("the vertex's z"));
    }
    polygons.line.push_back(text.line());
    for (const char* end : {"endloop", "endfacet"}) {
      text.next_with_words(fmt::format("'{}'", end));
      if (word_or_end(text) != end) throw InputError(text.place(), fmt::format("expected '{}'", end));
    }
    add_triangle(polygons);
  }
}

}  // namespace

UncheckedPolygons parse_stl(std::string_view content, const std::string& file) {
  return is_binary(content) ? parse_binary(content, file) : parse_text(content, file);
}

}  // namespace tubefoot
