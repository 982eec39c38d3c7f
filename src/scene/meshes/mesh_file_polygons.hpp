// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "scene/meshes/mesh_file.hpp"

namespace tubefoot {

/// What a mesh file says, face by face, before it is checked and cut into triangles.
struct UncheckedPolygons {
  std::vector<glm::dvec3> points;
  std::vector<std::uint32_t> corners;           ///< of all polygons, one after the other
  std::vector<std::size_t> end;                 ///< per polygon: where its corners end
  std::vector<int> line;                        ///< per polygon: its line in the file; empty for binary files
  int first_index = 0;                          ///< what the file counts vertices from, for messages
  std::vector<std::vector<std::string>> names;  ///< as in NamedMesh
  std::vector<std::uint32_t> names_of;          ///< per polygon; empty: the file has no names
  std::vector<std::string> warnings;

  /// Ends a polygon of the corners since the last one.
  void end_polygon() { end.push_back(corners.size()); }
};

/// The readers of the formats: `content` is the whole file, `file` names it in errors. They check numbers,
/// syntax and completeness; indices are checked by triangulate.
UncheckedPolygons parse_obj(std::string_view content, const std::string& file);
UncheckedPolygons parse_off(std::string_view content, const std::string& file);
UncheckedPolygons parse_ply(std::string_view content, const std::string& file);
UncheckedPolygons parse_stl(std::string_view content, const std::string& file);

/// Cuts polygons into triangles, in order (polygon_cutter.hpp). Faces of less than three corners are counted
/// in a warning, and so are polygons that are not flat. Drops points that no face uses. Throws InputError for
/// an index out of range, a polygon that crosses itself, no face at all.
NamedMesh triangulate(UncheckedPolygons polygons, const std::string& file);

}  // namespace tubefoot
