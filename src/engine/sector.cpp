// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/sector.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>

namespace tubefoot {
namespace {

/// Radians; far more than the rounding of unit vectors.
constexpr double slack = 1e-9;

glm::dvec3 unit_ray(GridPoint p) { return glm::normalize(glm::dvec3(p.x, p.y, p.z)); }

/// Exactly 0 for equal vectors, where acos is not.
double angle(glm::dvec3 a, glm::dvec3 b) { return 2 * std::asin(std::min(1.0, glm::distance(a, b) / 2)); }

}  // namespace

Sector::Sector(const TubeSet& tubes, double grid_unit_m)
    : apex_(tubes.apex), unit_m_(grid_unit_m), reach_(tubes.reach), narrowest_rad_(glm::half_pi<double>()) {
  // Neighbours lie side by side, so that a few of them are as good as convex.
  constexpr std::size_t most_together = 8;
  constexpr double widest_rad = 0.7;
  std::size_t first = 0;
  for (std::size_t t = 0; t < tubes.tubes.size(); ++t) {
    const Tube& tube = tubes.tubes[t];
    for (std::size_t k = 0; k < 4; ++k)
      narrowest_rad_ = std::min(
          narrowest_rad_, angle(unit_ray(tubes.rays[tube[k]]), unit_ray(tubes.rays[tube[(k + 1) % 4]])));
    double farthest = 0;
    for (const std::uint32_t ray : tube)
      farthest = std::max(farthest,
                          angle(unit_ray(tubes.rays[ray]), unit_ray(tubes.rays[tubes.tubes[first].front()])));
    if (t > first && (t - first == most_together || farthest > widest_rad)) {
      add(tubes, first, t);
      first = t;
    }
  }
  if (first < tubes.tubes.size()) add(tubes, first, tubes.tubes.size());
}

void Sector::add(const TubeSet& tubes, std::size_t first, std::size_t end) {
  std::vector<glm::dvec3> rays;
  std::vector<std::uint32_t> names;
  for (std::size_t t = first; t < end; ++t)
    names.insert(names.end(), tubes.tubes[t].begin(), tubes.tubes[t].end());
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  glm::dvec3 sum{0};
  for (const std::uint32_t name : names) {
    rays.push_back(unit_ray(tubes.rays[name]));
    sum += rays.back();
  }
  Pyramid pyramid{glm::normalize(sum), 0, {}, {}};
  for (const glm::dvec3& ray : rays)
    pyramid.spread_rad = std::max(pyramid.spread_rad, angle(pyramid.axis, ray));
  // The sides of the rays' convex hull: planes through two of them that have none outside. Leaving one out
  // is safe, so that the first few of very many do.
  constexpr std::size_t most_sides = 24;
  for (std::size_t i = 0; i < rays.size(); ++i)
    for (std::size_t j = i + 1; j < rays.size() && pyramid.inward.size() < most_sides; ++j) {
      glm::dvec3 normal = glm::cross(rays[i], rays[j]);
      const double length = glm::length(normal);
      if (length < 1e-7) continue;
      normal /= length;
      double lowest = 0, highest = 0;
      for (const glm::dvec3& ray : rays) {
        lowest = std::min(lowest, glm::dot(normal, ray));
        highest = std::max(highest, glm::dot(normal, ray));
      }
      if (lowest < -slack && highest > slack) continue;
      if (lowest < -slack) normal = -normal;
      const bool known = std::any_of(pyramid.inward.begin(), pyramid.inward.end(),
                                     [&](const glm::dvec3& n) { return glm::distance(n, normal) < 1e-7; });
      if (!known) pyramid.inward.push_back(normal);
    }
  pyramid.rays = std::move(rays);
  pyramids_.push_back(std::move(pyramid));
}

bool Sector::may_meet(glm::dvec3 place_m, double radius_m) const {
  const double range = glm::length(place_m);
  if (range - radius_m > reach_ * unit_m_) return false;
  const double margin = radius_m + 4 * slack * range;
  if (range <= margin) return true;
  const double half_rad = std::asin(margin / range);
  return std::any_of(pyramids_.begin(), pyramids_.end(), [&](const Pyramid& p) {
    const double within = p.spread_rad + half_rad + 4 * slack;
    if (within < glm::half_pi<double>() && glm::dot(p.axis, place_m) < range * std::cos(within)) return false;
    return std::all_of(p.inward.begin(), p.inward.end(),
                       [&](const glm::dvec3& n) { return glm::dot(n, place_m) >= -margin; });
  });
}

std::vector<FacetId> Sector::facets(const SceneTree& tree, double margin_m) const {
  std::vector<FacetId> all;
  for (const Pyramid& p : pyramids_) {
    std::vector<SceneTree::HalfSpace> sides;
    for (const glm::dvec3& n : p.inward) sides.push_back({n.x, n.y, n.z});
    // The slack of the sides, on top, at the largest distance.
    const double margin = margin_m / unit_m_ + 4 * slack * reach_ + 1;
    tree.query(apex_, sides, reach_ + margin, margin, all);
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

// Turned by s in its vertical plane, a direction u becomes u cos s + e sin s, with e straight across it.
bool Sector::may_meet_turned(glm::dvec3 place_m, double radius_m, double turn_rad, double stretch) const {
  const double range = glm::length(place_m), across = std::hypot(place_m.x, place_m.y);
  if (stretch * (range - radius_m) > reach_ * unit_m_) return false;
  if (across <= 2 * radius_m) return true;  // around the vertical, where e turns fast
  const glm::dvec3 e{-place_m.z * place_m.x / across, -place_m.z * place_m.y / across, across};
  const double sine = std::sin(turn_rad), cosine = std::cos(turn_rad);
  // Turned points part by as much more as they come farther from the vertical.
  const double margin = radius_m * (1 + std::abs(place_m.z) / (across - radius_m) * sine) + 4 * slack * range;
  return std::any_of(pyramids_.begin(), pyramids_.end(), [&](const Pyramid& p) {
    return std::all_of(p.inward.begin(), p.inward.end(), [&](const glm::dvec3& n) {
      const double along = glm::dot(n, place_m), beside = std::abs(glm::dot(n, e));
      // At most as far inside as that: as far as the best turn leads, or else the largest.
      if (along * sine >= beside * cosine) return true;
      const double inside = along * cosine + beside * sine;
      return inside >= -margin;
    });
  });
}

std::vector<FacetId> Sector::facets_turned(const SceneTree& tree, double turn_rad, double stretch,
                                           double margin_m) const {
  std::vector<FacetId> all;
  const double moved_by = margin_m / unit_m_ + 1, reach = reach_ / stretch + moved_by;
  for (const Pyramid& p : pyramids_) {
    // How far turning moves a direction of the pyramid across a side: sides that it hardly crosses, such as
    // those of an upright fan, are kept.
    constexpr double most_crossing = 0.2;
    std::vector<SceneTree::HalfSpace> sides;
    double margin = 0;
    for (const glm::dvec3& n : p.inward) {
      double crossing = 0;
      for (const glm::dvec3& u : p.rays) {
        const double across = std::hypot(u.x, u.y);
        crossing = std::max(crossing, across > 0 ? std::abs(n.z - u.z * glm::dot(n, u)) / across : 1.0);
      }
      // Twice: what lies between the rays.
      const double moved = 2 * crossing * std::sin(turn_rad);
      if (crossing > most_crossing || turn_rad > glm::half_pi<double>()) continue;
      sides.push_back({n.x, n.y, n.z});
      margin = std::max(margin, moved);
    }
    tree.query(apex_, sides, reach, margin * reach + 4 * slack * reach + moved_by, all);
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

}  // namespace tubefoot
