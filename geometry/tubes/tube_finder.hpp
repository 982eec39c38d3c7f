// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "geometry/tubes/tube.hpp"

namespace tubefoot {

/// Finds the tubes that contain a direction. If a direction is so near to a wall that rounding decides, it
/// lies in exactly one of the two tubes that share the wall.
class TubeFinder {
 public:
  /// Does not keep a reference to `tubes`.
  explicit TubeFinder(const TubeSet& tubes);

  /// Calls take(tube) for each tube that contains the direction (of any length except 0), in their order.
  template <class Take>
  void find(glm::dvec3 direction, const Take& take) const {
    const std::size_t cell = cell_of(direction);
    for (std::uint32_t k = begin_[cell]; k < begin_[cell + 1]; ++k)
      if (holds(walls_[in_cells_[k]], direction)) take(in_cells_[k]);
  }

 private:
  /// Inward normal, 0 if two corners coincide. A direction on the wall is inside if the wall is the tube's
  /// own.
  struct Wall {
    glm::dvec3 normal;
    bool own;
  };
  using Walls = std::array<Wall, 4>;
  static bool holds(const Walls& walls, glm::dvec3 direction) {
    for (const Wall& wall : walls) {
      const double side = glm::dot(wall.normal, direction);
      if (!(side > 0 || (side == 0 && wall.own))) return false;
    }
    return true;
  }
  std::size_t cell_of(glm::dvec3 direction) const;

  int cells_ = 0;  // number of cells along an edge of the cube on whose six faces the cells lie
  std::vector<Walls> walls_;
  std::vector<std::uint32_t> begin_, in_cells_;  // per cell: tubes that may reach into it
};

}  // namespace tubefoot
