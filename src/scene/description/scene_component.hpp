// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

namespace tubefoot {

/// Facets of one component before they are placed on the world grid. Every source of geometry returns this
/// type.
struct ComponentMesh {
  std::vector<glm::dvec3> points_m;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint16_t> materials;  ///< by triangle; empty for the component's own material
  std::size_t hole_cells = 0;  ///< rasters: cells that are partly or wholly open because a corner has no data
  std::vector<std::string> warnings;  ///< warnings about the source for the user
};

/// Removes the points that no triangle uses, because they would enlarge the extent of the scene.
void drop_unused_points(ComponentMesh& mesh);

}  // namespace tubefoot
