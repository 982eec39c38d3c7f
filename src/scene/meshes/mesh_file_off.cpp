// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <limits>

#include "scene/meshes/mesh_file_polygons.hpp"
#include "scene/meshes/mesh_file_text.hpp"

// Reads the Object File Format (Geomview), ASCII: [ST][C][N]OFF, the counts of vertices, faces and edges,
// then one line per vertex and face.
namespace tubefoot {
namespace {

std::int64_t count(TextLines& text, std::string_view what) {
  const std::int64_t value = text.integer(what);
  if (value < 0 || value >= std::numeric_limits<std::uint32_t>::max()) {
    throw InputError(text.place(), fmt::format("{} is {}, expected 0 to 2^32 - 2", what, value));
  }
  return value;
}

std::string capitals(std::string_view word) {
  std::string text(word);
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return char(std::toupper(c)); });
  return text;
}

bool is_number(std::string_view word) {
  return !word.empty() && word.find_first_not_of("0123456789") == word.npos;
}

}  // namespace

UncheckedPolygons parse_off(std::string_view content, const std::string& file) {
  UncheckedPolygons polygons;
  TextLines text(content, file);
  text.next_with_words("the word OFF");
  TextLines after_magic = text;  // the counts may follow on the same line
  const std::string magic = capitals(after_magic.word());
  if (!is_number(magic)) {  // some writers leave the word out
    if (magic != "OFF" && magic != "COFF" && magic != "NOFF" && magic != "CNOFF" && magic != "STOFF" &&
        magic != "STCNOFF" && magic != "STCOFF" && magic != "STNOFF")
      throw InputError(after_magic.place(),
                       "expected a header OFF, COFF, NOFF or STOFF (three coordinates per vertex)");
    text = after_magic;
    const std::string next = capitals(after_magic.word());
    if (next == "BINARY")
      throw InputError(after_magic.place(),
                       "tubefoot does not read binary OFF: convert it to PLY or ASCII OFF");
    if (next.empty() || next[0] == '#') text.next_with_words("the counts of vertices, faces and edges");
  }
  const std::int64_t vertices = count(text, "the number of vertices"),
                     faces = count(text, "the number of faces");

  // A wrong count must not cause an allocation larger than the file can fill. A line has at least 6
  // characters.
  const std::size_t most_lines = content.size() / 6;
  polygons.points.reserve(std::min<std::size_t>(vertices, most_lines));
  polygons.corners.reserve(3 * std::min<std::size_t>(faces, most_lines));
  polygons.end.reserve(std::min<std::size_t>(faces, most_lines));
  for (std::int64_t i = 0; i < vertices; ++i) {
    text.next_with_words(fmt::format("vertex {} of {}", i + 1, vertices));
    const double x = text.number("the vertex's x"), y = text.number("the vertex's y");
    polygons.points.emplace_back(x, y, text.number("the vertex's z"));
  }
  for (std::int64_t i = 0; i < faces; ++i) {
    text.next_with_words(fmt::format("face {} of {}", i + 1, faces));
    const std::int64_t corners = count(text, "the face's number of corners");
    for (std::int64_t k = 0; k < corners; ++k) {
      const std::int64_t index = text.integer("the face's vertex index");
      if (index < 0 || index >= vertices) {
        throw InputError(text.place(),
                         fmt::format("vertex index {} is out of range: the file holds {} vertices, "
                                     "counted from 0",
                                     index, vertices));
      }
      polygons.corners.push_back(static_cast<std::uint32_t>(index));
    }
    polygons.end_polygon();
    polygons.line.push_back(text.line());
  }
  return polygons;
}

}  // namespace tubefoot
