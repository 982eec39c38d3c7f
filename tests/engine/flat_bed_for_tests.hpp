// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "geometry/mesh/facet_mesh.hpp"

namespace tubefoot::test {

/// A square of 2 * half_m about the origin, below_m under it, in square cells of two facets each.
inline void add_flat_bed(MeshBuilder& builder, double half_m, double cell_m, double below_m) {
  std::vector<glm::dvec3> points;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (double x = -half_m; x < half_m; x += cell_m)
    for (double y = -half_m; y < half_m; y += cell_m) {
      const auto i = std::uint32_t(points.size());
      for (const glm::dvec2 corner : {glm::dvec2(0, 0), {1, 0}, {1, 1}, {0, 1}})
        points.emplace_back(x + cell_m * corner.x, y + cell_m * corner.y, -below_m);
      triangles.push_back({i, i + 1, i + 2});
      triangles.push_back({i, i + 2, i + 3});
    }
  builder.add(points, triangles, 0, 0);
}

}  // namespace tubefoot::test
