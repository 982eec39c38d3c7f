// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/water/apparent_map.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

// Computes apparent positions from eigenrays: direction = launch direction, distance = reference speed times
// travel time. It also computes the quantities of facet corners for facet_factor(). See
// docs/notes/refraction.md.
namespace tubefoot {

ApparentMap::ApparentMap(const WaterColumn& water, glm::dvec3 apex_m, double surface_height_m,
                         const EigenrayOptions& options, std::optional<double> reference_speed_m_s,
                         const Unfolding& unfolding, const SurfaceApex& surface_apex)
    : finder_(water, surface_height_m - apex_m.z, options),
      apex_m_(apex_m),
      surface_height_m_(surface_height_m),
      reference_speed_m_s_(reference_speed_m_s.value_or(finder_.source_speed_m_s())),
      unfolding_(unfolding),
      surface_apex_(surface_apex) {}

ApparentPoint ApparentMap::straight_to(glm::dvec3 point_m) const {
  const glm::dvec3 path = point_m - apex_m_;
  const double c = finder_.source_speed_m_s(), depth_m = finder_.source_depth_m(),
               length_m = std::max(glm::length(path), 1e-9);  // less than a grid unit
  Eigenray ray;
  ray.launch_sine = ray.arrival_sine = -path.z / length_m;
  ray.launch_cosine = ray.arrival_cosine = std::hypot(path.x, path.y) / length_m;
  ray.time_s = length_m / c;
  ray.length_m = length_m;
  ray.absorption_db = water().absorption_in(water().profile.layer_at(depth_m)) * length_m;
  ray.tube_area_m2_per_sr = length_m * length_m;
  return {apex_m_ + reference_speed_m_s_ / c * path, ray, 1};
}

std::optional<ApparentPoint> ApparentMap::apparent(glm::dvec3 point_m,
                                                   std::vector<ApparentPoint>* each) const {
  const glm::dvec3 path = point_m - apex_m_;
  if (surface_apex_.straight_within_m > 0 && glm::length(path) <= surface_apex_.straight_within_m)
    return straight_to(point_m);
  const double range = std::hypot(path.x, path.y);
  const double depth = depth_m(point_m);
  Eigenray first;
  std::size_t count = 1;
  if (finder_.may_turn_towards(depth, range)) {
    std::vector<Eigenray> rays = finder_.all(depth, range);
    if (rays.empty()) return std::nullopt;
    first = rays.front();
    count = rays.size();
    if (each != nullptr && count > 1) *each = seen_by(rays, point_m);
    if (surface_apex_.front != glm::dvec3(0) && count > 1) {
      // A ray that starts into the seabed cannot lead to a visible point.
      std::erase_if(rays, [&](const Eigenray& ray) {
        const double across = range > 0 ? ray.launch_cosine / range : 0;
        return !(glm::dot(surface_apex_.front,
                          glm::dvec3(across * path.x, across * path.y, -ray.launch_sine)) > 0);
      });
      if (!rays.empty()) first = rays.front();
      count = std::max<std::size_t>(rays.size(), 1);
    }
  } else {
    const std::optional<Eigenray> only = finder_.direct(depth, range);
    if (!only) return std::nullopt;
    first = *only;
  }
  return seen_by(first, point_m, count);
}

ApparentPoint ApparentMap::seen_by(const Eigenray& ray, glm::dvec3 point_m, std::size_t rays) const {
  const glm::dvec3 path = point_m - apex_m_;
  const double range = std::hypot(path.x, path.y), distance = reference_speed_m_s_ * ray.time_s;
  // A vertical ray has no azimuth and does not need one.
  const double across = range > 0 ? distance * ray.launch_cosine / range : 0;
  return {
      apex_m_ + glm::dvec3(across * path.x, across * path.y, -unfolding_.sign * distance * ray.launch_sine),
      ray, static_cast<int>(rays)};
}

std::vector<ApparentPoint> ApparentMap::seen_by(std::vector<Eigenray> rays, glm::dvec3 point_m) const {
  std::ranges::sort(rays, {}, [](const Eigenray& ray) { return ray.launch_sine; });
  std::vector<ApparentPoint> all;
  for (const Eigenray& ray : rays) all.push_back(seen_by(ray, point_m, rays.size()));
  return all;
}

std::vector<ApparentPoint> ApparentMap::all_apparent(glm::dvec3 point_m) const {
  const glm::dvec3 path = point_m - apex_m_;
  return seen_by(finder_.all(depth_m(point_m), std::hypot(path.x, path.y)), point_m);
}

glm::dvec3 ApparentMap::launch_direction(glm::dvec3 point_m, const Eigenray& ray) const {
  const glm::dvec3 path = point_m - apex_m_;
  const double range = std::hypot(path.x, path.y);
  const double across = range > 0 ? ray.launch_cosine / range : 0;
  return {across * path.x, across * path.y, -unfolding_.sign * ray.launch_sine};
}

glm::dvec3 ApparentMap::arrival_direction(glm::dvec3 point_m, const Eigenray& ray) const {
  const glm::dvec3 path = point_m - apex_m_;
  const double range = std::hypot(path.x, path.y);
  const double across = range > 0 ? ray.arrival_cosine / range : 0;
  return {across * path.x, across * path.y, -unfolding_.sign * ray.arrival_sine};
}

double ApparentMap::return_area_m2_per_sr(glm::dvec3 point_m, const Eigenray& ray) const {
  const double speeds = finder_.source_speed_m_s() / water().profile.at(depth_m(point_m));
  return ray.tube_area_m2_per_sr * speeds * speeds;
}

double edge_travel_path_error_m(glm::dvec3 a, glm::dvec3 b, glm::dvec3 middle) {
  return glm::length(middle - (a + b) / 2.0);
}

CornerReturn corner_return(const ApparentMap& apparent_map, glm::dvec3 point_m, const ApparentPoint& image,
                           double reference_absorption_db_per_m) {
  const double range = apparent_map.reference_speed_m_s() * image.ray.time_s;
  const double back = apparent_map.return_area_m2_per_sr(point_m, image.ray),
               beyond_db = image.ray.absorption_db - reference_absorption_db_per_m * range;
  return {apparent_map.arrival_direction(point_m, image.ray),
          std::exp(-2 * image.ray.absorption_db * std::numbers::ln10 / 10) /
              (image.ray.tube_area_m2_per_sr * back),
          range * range / back * std::exp(-2 * beyond_db * std::numbers::ln10 / 10)};
}

}  // namespace tubefoot
