// SPDX-License-Identifier: GPL-3.0-or-later
#include "medium/straightening.hpp"

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace tubefoot {

Straightening::Straightening(const WaterColumn& water, glm::dvec3 apex_m, double surface_height_m,
                             const EigenrayOptions& options)
    : finder_(water, surface_height_m - apex_m.z, options),
      apex_m_(apex_m),
      surface_height_m_(surface_height_m) {}

std::optional<ApparentPoint> Straightening::apparent(glm::dvec3 point_m) const {
  const glm::dvec3 way = point_m - apex_m_;
  const double range = std::hypot(way.x, way.y);
  const std::vector<Eigenray> rays = finder_.all(depth_m(point_m), range);
  if (rays.empty()) return std::nullopt;
  const Eigenray& first = rays.front();
  const double distance = finder_.source_speed_m_s() * first.time_s;
  // A vertical ray has no azimuth and needs none.
  const double across = range > 0 ? distance * first.launch_cosine / range : 0;
  return ApparentPoint{apex_m_ + glm::dvec3(across * way.x, across * way.y, -distance * first.launch_sine),
                       first, static_cast<int>(rays.size())};
}

glm::dvec3 Straightening::arrival_direction(glm::dvec3 point_m, const Eigenray& ray) const {
  const glm::dvec3 way = point_m - apex_m_;
  const double range = std::hypot(way.x, way.y);
  const double across = range > 0 ? ray.arrival_cosine / range : 0;
  return {across * way.x, across * way.y, -ray.arrival_sine};
}

double Straightening::return_area_m2_per_sr(glm::dvec3 point_m, const Eigenray& ray) const {
  const double speeds = finder_.source_speed_m_s() / water().profile.at(depth_m(point_m));
  return ray.tube_area_m2_per_sr * speeds * speeds;
}

double edge_gap_m(glm::dvec3 a, glm::dvec3 b, glm::dvec3 middle) {
  return glm::length(middle - (a + b) / 2.0);
}

std::optional<double> facet_factor(const Straightening& straightening, const glm::dvec3 (&corners_m)[3],
                                   const glm::dvec3 (&apparent_m)[3], double reference_absorption_db_per_m) {
  const auto centre = [](const glm::dvec3(&c)[3]) { return (c[0] + c[1] + c[2]) / 3.0; };
  const auto normal = [](const glm::dvec3(&c)[3]) {
    const glm::dvec3 n = glm::cross(c[1] - c[0], c[2] - c[0]);
    const double length = glm::length(n);
    return length > 0 ? n / length : glm::dvec3(0);
  };
  const glm::dvec3 at = centre(corners_m);
  const auto image = straightening.apparent(at);
  if (!image) return std::nullopt;
  // The image facet is flat: its own centre, not the image of the true one, is what the straight law sees.
  const glm::dvec3 seen = centre(apparent_m) - straightening.apex_m();
  const double range = glm::length(seen);
  const double sine_true =
      std::abs(glm::dot(normal(corners_m), straightening.arrival_direction(at, image->ray)));
  const double sine_seen = std::abs(glm::dot(normal(apparent_m), seen)) / range;
  if (!(sine_seen > 0)) return 0;
  const double beyond_db = image->ray.absorption_db - reference_absorption_db_per_m * range;
  return sine_true / sine_seen * range * range / straightening.return_area_m2_per_sr(at, image->ray) *
         std::exp(-2 * beyond_db * std::numbers::ln10 / 10);
}

}  // namespace tubefoot
