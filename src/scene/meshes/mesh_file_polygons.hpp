// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "scene/meshes/mesh_file.hpp"

namespace tubefoot {

/// The faces of a mesh file before they are checked and divided into triangles.
struct UncheckedPolygons {
  std::vector<glm::dvec3> points;
  std::vector<std::uint32_t> corners;           ///< corners of all polygons in sequence
  std::vector<std::size_t> end;                 ///< index after the last corner, by polygon
  std::vector<int> line;                        ///< line in the file, by polygon; empty for binary files
  int first_index = 0;                          ///< number of the first vertex in the file, for messages
  std::vector<std::vector<std::string>> names;  ///< as in NamedMesh
  std::vector<std::uint32_t> names_of;  ///< index in `names`, by polygon; empty if the file has no names
  std::vector<std::string> warnings;

  /// Ends a polygon that consists of the corners since the last one.
  void end_polygon() { end.push_back(corners.size()); }
};

/// Readers of the formats. `content` is the whole file, and `file` names it in errors. They check numbers,
/// syntax and completeness. triangulate() checks indices.
UncheckedPolygons parse_obj(std::string_view content, const std::string& file);
UncheckedPolygons parse_off(std::string_view content, const std::string& file);
UncheckedPolygons parse_ply(std::string_view content, const std::string& file);
UncheckedPolygons parse_stl(std::string_view content, const std::string& file);

/// Divides polygons into triangles, in order (polygon_cutter.hpp). Warnings count faces with fewer than
/// three corners, and polygons that are not flat. Points without a face are removed. Throws InputError for
/// an index out of range, a self-intersecting polygon, and a mesh without faces.
NamedMesh triangulate(UncheckedPolygons polygons, const std::string& file);

}  // namespace tubefoot
