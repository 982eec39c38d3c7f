// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/tubes/window_tubes.hpp"

#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>

#include "geometry/mesh/facet_cone.hpp"

namespace tubefoot {
namespace {

constexpr double ray_length = double(1 << 29);

GridPoint rounded(glm::dvec3 direction) {
  const glm::dvec3 ray = direction * (ray_length / glm::length(direction));
  return {static_cast<std::int32_t>(std::lround(ray.x)), static_cast<std::int32_t>(std::lround(ray.y)),
          static_cast<std::int32_t>(std::lround(ray.z))};
}

int turn(GridPoint a, GridPoint b, GridPoint c) { return sign(dot(cross(a, b), c)); }

/// Removes corners, with their numbers, until all turn left.
void make_convex(std::vector<GridPoint>& corners, std::vector<std::uint32_t>& numbers) {
  for (std::size_t since_change = 0, k = 0; corners.size() >= 3 && since_change < corners.size();) {
    const std::size_t n = corners.size();
    if (turn(corners[(k + n - 1) % n], corners[k % n], corners[(k + 1) % n]) > 0) {
      ++since_change;
      ++k;
    } else {
      corners.erase(corners.begin() + static_cast<std::ptrdiff_t>(k % n));
      numbers.erase(numbers.begin() + static_cast<std::ptrdiff_t>(k % n));
      since_change = k = 0;  // the turns at its neighbours have changed
    }
  }
}

}  // namespace

WindowTubes::WindowTubes(GridPoint apex, double reach) {
  set_.apex = apex;
  set_.reach = reach;
}

std::uint32_t WindowTubes::ray(GridPoint direction) {
  const auto [at, is_new] = rays_.emplace(direction, static_cast<std::uint32_t>(set_.rays.size()));
  if (is_new) set_.rays.push_back(direction);
  return at->second;
}

void WindowTubes::add(std::span<const glm::dvec3> corners, std::uint32_t label) {
  corners_.clear();
  for (const glm::dvec3& corner : corners) corners_.push_back(rounded(corner));
  kept_.resize(corners_.size());
  std::iota(kept_.begin(), kept_.end(), 0);
  make_convex(corners_, kept_);
  const std::size_t n = corners_.size();
  for (std::size_t k = 1; k + 1 < n; k += 2) {
    const GridPoint a = corners_[0], b = corners_[k], c = corners_[k + 1];
    if (k + 2 < n) {
      set_.tubes.push_back({ray(a), ray(b), ray(c), ray(corners_[k + 2])});
      numbers_.push_back({kept_[0], kept_[k], kept_[k + 1], kept_[k + 2]});
    } else {
      set_.tubes.push_back({ray(a), ray(b), ray({b.x + c.x, b.y + c.y, b.z + c.z}), ray(c)});
      numbers_.push_back({kept_[0], kept_[k], kept_[k], kept_[k + 1]});
    }
    labels_.push_back(label);
  }
}

bool holds(const TubeSet& set, std::uint32_t tube, GridPoint direction, double slack_rad) {
  const glm::dvec3 d(direction.x, direction.y, direction.z);
  for (std::size_t k = 0; k < 4; ++k) {
    const Vec64 wall = cross(set.rays[set.tubes[tube][k]], set.rays[set.tubes[tube][(k + 1) % 4]]);
    const Int128 above = dot(wall, direction);
    if (above >= 0) continue;
    const glm::dvec3 normal(double(wall.x), double(wall.y), double(wall.z));
    if (-static_cast<double>(above) >= slack_rad * glm::length(normal) * glm::length(d)) return false;
  }
  return true;
}

}  // namespace tubefoot
