// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/detection/sounding_grid.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>

namespace tubefoot {
namespace {

bool belongs_into_a_grid(const Sounding& sounding) {
  const glm::dvec3& p = sounding.position_m;
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z) &&
         !sounding.flags.has(DetectionFlag::cut_by_window);
}

/// Angle between two directions; 0 if one of them has no length.
double angle_between(const glm::dvec3& a, const glm::dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

}  // namespace

bool fills_between(const MeasuredFrom& a, const MeasuredFrom& b, double cell_m) {
  constexpr double farthest_cells = 2, farthest = 2;
  const glm::dvec3 from_a = a.sounding.position_m - a.sonar_m, from_b = b.sounding.position_m - b.sonar_m;
  const glm::dvec3 way = b.sounding.position_m - a.sounding.position_m;
  const double distance_m = std::hypot(way.x, way.y);
  if (distance_m <= farthest_cells * cell_m) return true;
  const double angle = angle_between(from_a, from_b);
  // On a level seabed at the depth h below the sonar, a small angle spans R^2 / h times as many metres.
  const auto spanned_m = [&](const glm::dvec3& ray) {
    return ray.z < 0 ? angle * glm::dot(ray, ray) / -ray.z : std::numeric_limits<double>::infinity();
  };
  const double expected_m =
      std::max(spanned_m(from_a), spanned_m(from_b)) + glm::distance(a.sonar_m, b.sonar_m);
  return distance_m <= farthest * expected_m;
}

SoundingGrid::SoundingGrid(LocalFrame frame, double cell_m) : frame_(std::move(frame)), depths_(cell_m) {}

void SoundingGrid::add(const Sounding& sounding) {
  if (belongs_into_a_grid(sounding)) add(sounding.position_m, 1);
}

void SoundingGrid::add_between(const Sounding& from, const Sounding& to) {
  if (!belongs_into_a_grid(from) || !belongs_into_a_grid(to)) return;
  const glm::dvec3 way = to.position_m - from.position_m;
  // Two steps per cell, so that the line visits every cell of which it crosses more than half.
  const int steps = static_cast<int>(std::ceil(2 * std::hypot(way.x, way.y) / depths_.cell_m()));
  constexpr double next_to_nothing = 1e-9;
  for (int k = 1; k < steps; ++k)
    add(from.position_m + way * (static_cast<double>(k) / steps), next_to_nothing);
}

void SoundingGrid::add(glm::dvec3 p, double weight) {
  depths_.add(p.x, p.y, -(p.z + frame_.origin_height_m()), weight);
}

void SoundingGrid::write_tiff(const std::filesystem::path& file) const {
  write_cells(file, depths_, frame_, "Depth", "m");
}

}  // namespace tubefoot
