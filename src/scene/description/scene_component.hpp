// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

namespace tubefoot {

/// Facets of one component before they are put on the world grid: what every source of geometry returns.
struct ComponentMesh {
  std::vector<glm::dvec3> points_m;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint16_t> materials;  ///< per triangle; empty: the component's own
  std::size_t hole_cells = 0;  ///< rasters: cells left wholly or partly open because a corner has no data
  std::vector<std::string> warnings;  ///< what the user should know about the source
};

/// Leaves out the points that no triangle uses: they would only stretch the scene's extent.
void drop_unused_points(ComponentMesh& mesh);

}  // namespace tubefoot
