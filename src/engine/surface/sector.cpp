// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/surface/sector.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>

// Encloses groups of up to eight neighbouring tubes in convex pyramids and tests points, facets and boxes of
// directions against them. All tests are conservative and include a slack for rounding.
namespace tubefoot {
namespace {

/// In radians, far larger than the rounding of unit vectors.
constexpr double slack = 1e-9;

glm::dvec3 unit_ray(GridPoint p) { return glm::normalize(glm::dvec3(p.x, p.y, p.z)); }

/// Exactly 0 for equal vectors, unlike acos.
double angle(glm::dvec3 a, glm::dvec3 b) { return 2 * std::asin(std::min(1.0, glm::distance(a, b) / 2)); }

}  // namespace

Sector::Sector(const TubeSet& tubes, double grid_unit_m)
    : apex_(tubes.apex), unit_m_(grid_unit_m), reach_(tubes.reach), narrowest_rad_(glm::half_pi<double>()) {
  // Neighbouring tubes adjoin each other, so that a few of them form an almost convex region.
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
  Pyramid pyramid{glm::normalize(sum), 0, {}, 1, -1};
  for (const glm::dvec3& ray : rays)
    pyramid.spread_rad = std::max(pyramid.spread_rad, angle(pyramid.axis, ray));
  // The sides are those of the convex hull of the rays: planes through two rays with no ray outside.
  // Omitting a side is safe, so only the first sides are kept if there are very many.
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
  // Steep sides come first, because most positions lie outside of them.
  std::ranges::sort(pyramid.inward, {}, [](const glm::dvec3& n) { return std::abs(n.z); });
  // Along the arc between two rays below the horizon, directions may be lower than both rays. Between rays
  // above the horizon they may be higher. The difference is the rise of the middle of an arc over its ends.
  const double shortest = std::cos(std::min(pyramid.spread_rad, glm::half_pi<double>()));
  for (const glm::dvec3& u : rays) {
    const double far = shortest > 1e-6 ? u.z / shortest : std::copysign(1.0, u.z);
    pyramid.lowest_sine = std::max(-1.0, std::min({pyramid.lowest_sine, u.z, far}) - 4 * slack);
    pyramid.highest_sine = std::min(1.0, std::max({pyramid.highest_sine, u.z, far}) + 4 * slack);
  }
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
    // Adds the slack of the sides at the largest distance.
    const double margin = margin_m / unit_m_ + 4 * slack * reach_ + 1;
    tree.query(apex_, sides, reach_ + margin, margin, all);
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

// For the best azimuth, n . u is a sinusoid of the elevation. Its maximum lies at an end or where its slope
// is zero.
double DirectionBox::farthest_along(const glm::dvec3& n) const {
  const auto left_of = [](glm::dvec2 a, glm::dvec2 b) { return a.x * b.y - a.y * b.x >= 0; };
  const glm::dvec2 level{n.x, n.y};
  const double across = all_round || (left_of(from, level) && left_of(level, to))
                            ? std::sqrt(glm::dot(level, level))
                            : std::max(glm::dot(level, from), glm::dot(level, to));
  if (n.z * low_cosine > across * low_sine && n.z * high_cosine < across * high_sine)
    return std::sqrt(across * across + n.z * n.z);
  return std::max(across * low_cosine + n.z * low_sine, across * high_cosine + n.z * high_sine);
}

bool Sector::may_meet(const DirectionBox& box) const {
  return std::any_of(pyramids_.begin(), pyramids_.end(), [&](const Pyramid& p) {
    if (box.low_sine > p.highest_sine || box.high_sine < p.lowest_sine) return false;
    return std::all_of(p.inward.begin(), p.inward.end(),
                       [&](const glm::dvec3& n) { return box.farthest_along(n) >= -4 * slack; });
  });
}

std::pair<double, double> Sector::elevation_sines() const {
  double lowest = 1, highest = -1;
  for (const Pyramid& p : pyramids_) {
    lowest = std::min(lowest, p.lowest_sine);
    highest = std::max(highest, p.highest_sine);
  }
  return {lowest, highest};
}

}  // namespace tubefoot
