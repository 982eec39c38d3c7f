// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/targets/tube_walls.hpp"

#include <algorithm>
#include <cmath>

namespace tubefoot {
namespace {

/// Returns whether a direction lies on the inner side of a wall. Neighbours traverse their common wall in
/// opposite directions, so their normals are opposite, and exactly one of them returns true.
bool is_inside_of(const Vec64& n, GridPoint d) {
  const double x = double(n.x) * d.x, y = double(n.y) * d.y, z = double(n.z) * d.z, sum = x + y + z;
  // Each product has two roundings of 2^-53, and the sum has two more.
  if (std::abs(sum) > (std::abs(x) + std::abs(y) + std::abs(z)) * 0x1p-50) return sum > 0;
  const Int128 side = dot(n, d);
  if (side != 0) return side > 0;
  if (n.x != 0) return n.x > 0;
  if (n.y != 0) return n.y > 0;
  return n.z >= 0;
}

}  // namespace

TubeWalls::TubeWalls(const TubeSet& tubes) : apex_(tubes.apex) {
  walls_.reserve(tubes.tubes.size());
  for (const Tube& tube : tubes.tubes) {
    std::array<Vec64, 4>& walls = walls_.emplace_back();
    for (std::size_t k = 0; k < 4; ++k) walls[k] = cross(tubes.rays[tube[k]], tubes.rays[tube[(k + 1) % 4]]);
  }
}

bool TubeWalls::contains(std::uint32_t tube, GridPoint point) const {
  const GridPoint d = point - apex_;
  return d != GridPoint{} &&
         std::ranges::all_of(walls_[tube], [&](const Vec64& normal) { return is_inside_of(normal, d); });
}

void TubeWalls::find(GridPoint point, std::vector<std::uint32_t>& tubes) const {
  tubes.clear();
  for (std::uint32_t tube = 0; tube < walls_.size(); ++tube)
    if (contains(tube, point)) tubes.push_back(tube);
}

}  // namespace tubefoot
