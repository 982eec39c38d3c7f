// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/description/scene_component.hpp"

#include <limits>

namespace tubefoot {

void drop_unused_points(ComponentMesh& mesh) {
  constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> renumbered(mesh.points_m.size(), kUnused);
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t index : triangle) renumbered[index] = 0;
  }
  std::uint32_t kept = 0;
  for (std::size_t i = 0; i < renumbered.size(); ++i) {
    if (renumbered[i] == kUnused) continue;
    mesh.points_m[kept] = mesh.points_m[i];
    renumbered[i] = kept++;
  }
  mesh.points_m.resize(kept);
  for (auto& triangle : mesh.triangles) {
    for (std::uint32_t& index : triangle) index = renumbered[index];
  }
}

}  // namespace tubefoot
