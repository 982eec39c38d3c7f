// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/water/straightening.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace tubefoot {

Straightening::Straightening(const WaterColumn& water, glm::dvec3 apex_m, double surface_height_m,
                             const EigenrayOptions& options, std::optional<double> reference_speed_m_s,
                             const Unfolding& unfolding)
    : finder_(water, surface_height_m - apex_m.z, options),
      apex_m_(apex_m),
      surface_height_m_(surface_height_m),
      reference_speed_m_s_(reference_speed_m_s.value_or(finder_.source_speed_m_s())),
      unfolding_(unfolding) {}

std::optional<ApparentPoint> Straightening::apparent(glm::dvec3 point_m) const {
  const glm::dvec3 way = point_m - apex_m_;
  const double range = std::hypot(way.x, way.y);
  const double depth = depth_m(point_m);
  Eigenray first;
  std::size_t count = 1;
  if (finder_.may_turn_towards(depth, range)) {
    const std::vector<Eigenray> rays = finder_.all(depth, range);
    if (rays.empty()) return std::nullopt;
    first = rays.front();
    count = rays.size();
  } else {
    const std::optional<Eigenray> only = finder_.direct(depth, range);
    if (!only) return std::nullopt;
    first = *only;
  }
  return seen_by(first, point_m, count);
}

ApparentPoint Straightening::seen_by(const Eigenray& ray, glm::dvec3 point_m, std::size_t rays) const {
  const glm::dvec3 way = point_m - apex_m_;
  const double range = std::hypot(way.x, way.y), distance = reference_speed_m_s_ * ray.time_s;
  // A vertical ray has no azimuth and needs none.
  const double across = range > 0 ? distance * ray.launch_cosine / range : 0;
  return {apex_m_ + glm::dvec3(across * way.x, across * way.y, -unfolding_.sign * distance * ray.launch_sine),
          ray, static_cast<int>(rays)};
}

std::vector<ApparentPoint> Straightening::all_apparent(glm::dvec3 point_m) const {
  const glm::dvec3 way = point_m - apex_m_;
  std::vector<Eigenray> rays = finder_.all(depth_m(point_m), std::hypot(way.x, way.y));
  std::ranges::sort(rays, {}, [](const Eigenray& ray) { return ray.launch_sine; });
  std::vector<ApparentPoint> all;
  for (const Eigenray& ray : rays) all.push_back(seen_by(ray, point_m, rays.size()));
  return all;
}

glm::dvec3 Straightening::arrival_direction(glm::dvec3 point_m, const Eigenray& ray) const {
  const glm::dvec3 way = point_m - apex_m_;
  const double range = std::hypot(way.x, way.y);
  const double across = range > 0 ? ray.arrival_cosine / range : 0;
  return {across * way.x, across * way.y, -unfolding_.sign * ray.arrival_sine};
}

double Straightening::return_area_m2_per_sr(glm::dvec3 point_m, const Eigenray& ray) const {
  const double speeds = finder_.source_speed_m_s() / water().profile.at(depth_m(point_m));
  return ray.tube_area_m2_per_sr * speeds * speeds;
}

double edge_gap_m(glm::dvec3 a, glm::dvec3 b, glm::dvec3 middle) {
  return glm::length(middle - (a + b) / 2.0);
}

CornerReturn corner_return(const Straightening& straightening, glm::dvec3 point_m, const ApparentPoint& image,
                           double reference_absorption_db_per_m) {
  const double range = straightening.reference_speed_m_s() * image.ray.time_s;
  const double back = straightening.return_area_m2_per_sr(point_m, image.ray),
               beyond_db = image.ray.absorption_db - reference_absorption_db_per_m * range;
  return {straightening.arrival_direction(point_m, image.ray),
          std::exp(-2 * image.ray.absorption_db * std::numbers::ln10 / 10) /
              (image.ray.tube_area_m2_per_sr * back),
          range * range / back * std::exp(-2 * beyond_db * std::numbers::ln10 / 10)};
}

}  // namespace tubefoot
