// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <optional>

#include "scene/meshes/mesh_file_polygons.hpp"
#include "scene/meshes/mesh_file_text.hpp"

// Reads Wavefront OBJ: `v x y z`, and `f a b c ...` with a = vertex[/texture[/normal]]. Indices count from
// 1; negative indices count backwards.
namespace tubefoot {
namespace {

// Statements without a facet of a polygonal mesh. Any other statement is an error, because a misspelt f
// would lose a facet.
constexpr std::array<std::string_view, 14> kPassed = {"vt",     "vn",     "vp",       "s",       "mg",
                                                      "mtllib", "usemap", "maplib",   "l",       "p",
                                                      "lod",    "bevel",  "c_interp", "d_interp"};

std::uint32_t vertex_index(std::string_view word, std::size_t vertices, const TextLines& text) {
  const std::int64_t value = text.parse_integer(word.substr(0, word.find('/')), "a face's vertex index");
  // Relative indices count back from the vertices read up to now. Others may refer to later vertices;
  // triangulate() checks them.
  const std::int64_t index = value < 0 ? static_cast<std::int64_t>(vertices) + value : value - 1;
  if (index < 0 || index >= std::numeric_limits<std::uint32_t>::max()) {
    throw InputError(
        text.place(),
        fmt::format("vertex index {} is out of range: the file has {} vertices up to here, counted from 1",
                    value, vertices));
  }
  return static_cast<std::uint32_t>(index);
}

/// The names of faces from a line on, by usemtl, by g and by o.
class FaceNames {
 public:
  static bool is_keyword(std::string_view keyword) {
    return keyword == "usemtl" || keyword == "g" || keyword == "o";
  }
  void read(std::string_view keyword, TextLines& text) {
    std::vector<std::string>& names = keyword == "usemtl" ? material_ : keyword == "g" ? groups_ : object_;
    names.clear();
    // A line g has several names. The other lines have one name, which may contain blanks.
    for (std::string_view word = text.word(); !word.empty() && word[0] != '#'; word = text.word()) {
      if (keyword == "g" || names.empty())
        names.emplace_back(word);
      else
        names.front().append(" ").append(word);
    }
    current_.reset();
  }
  /// Returns the index in `polygons.names` of the names of the next face.
  std::uint32_t index(UncheckedPolygons& polygons) {
    if (current_) return *current_;
    std::vector<std::string> names = material_;
    names.insert(names.end(), groups_.begin(), groups_.end());
    names.insert(names.end(), object_.begin(), object_.end());
    const auto [known, is_new] = index_of_.emplace(names, static_cast<std::uint32_t>(polygons.names.size()));
    if (is_new) polygons.names.push_back(std::move(names));
    current_ = known->second;
    return *current_;
  }

 private:
  std::vector<std::string> material_, groups_, object_;
  std::map<std::vector<std::string>, std::uint32_t> index_of_;
  std::optional<std::uint32_t> current_;
};

}  // namespace

UncheckedPolygons parse_obj(std::string_view content, const std::string& file) {
  UncheckedPolygons polygons;
  polygons.first_index = 1;
  TextLines text(content, file, true);
  std::string_view last_keyword;
  FaceNames names;
  while (text.next()) {
    const std::string_view keyword = text.word();
    if (keyword.empty() || keyword[0] == '#') continue;
    last_keyword = keyword;
    if (keyword == "v") {
      const double x = text.number("the vertex's x"), y = text.number("the vertex's y");
      polygons.points.emplace_back(x, y, text.number("the vertex's z"));
    } else if (keyword == "f" || keyword == "fo") {
      const std::size_t begin = polygons.corners.size();
      for (std::string_view word = text.word(); !word.empty() && word[0] != '#'; word = text.word()) {
        polygons.corners.push_back(vertex_index(word, polygons.points.size(), text));
      }
      // triangulate() leaves such a face out, unless it is the end of a truncated file.
      if (polygons.corners.size() - begin < 3 && text.rest().empty() && !content.ends_with('\n') &&
          !content.ends_with('\r'))
        throw InputError({file, text.line(), 0},
                         fmt::format("the last face has {} corners, and its line does not end with a "
                                     "newline: restore the file if it is cut off, or add the newline",
                                     polygons.corners.size() - begin));
      polygons.end_polygon();
      polygons.line.push_back(text.line());
      polygons.names_of.push_back(names.index(polygons));
    } else if (FaceNames::is_keyword(keyword)) {
      names.read(keyword, text);
    } else if (std::find(kPassed.begin(), kPassed.end(), keyword) == kPassed.end()) {
      throw InputError({file, text.line(), 1},
                       "the line does not start with an OBJ statement of a polygonal mesh (v, vt, vn, f, g, "
                       "o, s, usemtl, ...): export the model as a polygonal OBJ");
    }
  }
  if ((last_keyword == "v" || last_keyword == "f") && !content.ends_with('\n') && !content.ends_with('\r')) {
    polygons.warnings.push_back(
        fmt::format("{}:{}: the last line does not end with a newline; if the file is cut off, its last "
                    "number may be wrong",
                    file, text.line()));
  }
  return polygons;
}

}  // namespace tubefoot
