// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/paths/visible_surface.hpp"

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "engine/water/apparent_map.hpp"

namespace tubefoot {

RefractedFacet::Ray RefractedFacet::ray_to(glm::dvec3 lies_m) const {
  const glm::dvec3 part = parts.at(lies_m);
  const auto between = [&](double Ray::*what) {
    return corners[0].*what + part.x * (corners[1].*what - corners[0].*what) +
           part.y * (corners[2].*what - corners[0].*what);
  };
  return {between(&Ray::bend), between(&Ray::tx), between(&Ray::rx), between(&Ray::absorbed)};
}

double RefractedFacet::sine(glm::dvec3 seen_m, const Ray& ray) const {
  return ray.bend - glm::dot(normal, seen_m) / glm::length(seen_m);
}

RefractedFacet refracted_facet(glm::dvec3 apex_m, const glm::dvec3 (&seen_m)[3],
                               const glm::dvec3 (&lies_m)[3], const Eigenray (&rays)[3],
                               const ApparentMap& water, double reference_absorption_db_per_m) {
  glm::dvec3 lies[3], from_apex[3], arrival[3];
  for (std::size_t k = 0; k < 3; ++k) {
    lies[k] = lies_m[k] - apex_m;
    from_apex[k] = seen_m[k] - apex_m;
    arrival[k] = water.arrival_direction(lies_m[k], rays[k]);
  }
  RefractedFacet facet;
  facet.lies = facet_map(from_apex, lies);
  facet.seen = facet_map(lies, from_apex);
  facet.parts = facet_map(lies, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  const glm::dvec3 across = glm::cross(lies[1] - lies[0], lies[2] - lies[0]),
                   seen = glm::cross(from_apex[1] - from_apex[0], from_apex[2] - from_apex[0]);
  facet.normal = across / glm::length(across);
  facet.area_ratio = glm::length(across) / glm::length(seen);
  if (glm::dot(facet.normal, arrival[0] + arrival[1] + arrival[2]) > 0) facet.normal = -facet.normal;
  for (std::size_t k = 0; k < 3; ++k) {
    // Equals the distance of the apparent position, except for rounding to the grid.
    const double range_m = water.reference_speed_m_s() * rays[k].time_s;
    RefractedFacet::Ray& ray = facet.corners[k];
    ray.bend = glm::dot(facet.normal, water.launch_direction(lies_m[k], rays[k]) - arrival[k]);
    ray.absorbed = std::exp(-(rays[k].absorption_db - reference_absorption_db_per_m * range_m) *
                            std::numbers::ln10 / 10);
    ray.tx = range_m * range_m / rays[k].tube_area_m2_per_sr * ray.absorbed;
    ray.rx = range_m * range_m / water.return_area_m2_per_sr(lies_m[k], rays[k]) * ray.absorbed;
  }
  return facet;
}

}  // namespace tubefoot
