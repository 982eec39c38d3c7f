// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "scene/scene_component.hpp"

namespace tubefoot {

/// What a mesh file says, face by face, before it is checked and cut into triangles.
struct PolygonSoup {
  std::vector<glm::dvec3> points;
  std::vector<std::uint32_t> corners;  ///< of all polygons, one after the other
  std::vector<std::size_t> end;        ///< per polygon: where its corners end
  std::vector<int> line;               ///< per polygon: its line in the file; empty for binary files
  int first_index = 0;                 ///< what the file counts vertices from, for messages
  std::vector<std::string> warnings;
};

/// The readers of the formats: `content` is the whole file, `file` names it in errors. They check numbers,
/// syntax and completeness; indices are checked by triangulate.
PolygonSoup parse_obj(std::string_view content, const std::string& file);
PolygonSoup parse_off(std::string_view content, const std::string& file);
PolygonSoup parse_ply(std::string_view content, const std::string& file);
PolygonSoup parse_stl(std::string_view content, const std::string& file);

/// Cuts polygons into fans of triangles, in order. A polygon is fanned from a corner that sees all of it
/// where there is one (any convex polygon, any quadrangle); the others are counted in a warning. Drops points
/// that no face uses. Throws InputError for an index out of range, a face of fewer than three corners, no
/// face at all.
ComponentMesh triangulate(PolygonSoup soup, const std::string& file);

}  // namespace tubefoot
