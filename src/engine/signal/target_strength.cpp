// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/signal/target_strength.hpp"

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "geometry/integrals/polygon_transform.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {

std::vector<std::complex<double>> backscattering_lengths(
    const FarView& view, std::span<const glm::dvec3> points_m,
    std::span<const std::array<std::uint32_t, 3>> triangles, glm::dvec3 towards, const SmoothSurface& surface,
    std::span<const double> wave_numbers_per_m) {
  // (i.n) dS is an element of the silhouette, and the phase is -2k times its coordinate towards the viewer.
  // Thus f = -(ik / 2 pi) R times the integral over the silhouette. The formula does not use the plane of a
  // facet, which is ill-conditioned for facets seen edge-on.
  const bool same = !surface.fluid && surface.roughness_m == 0;
  std::vector<std::complex<double>> lengths(wave_numbers_per_m.size(), 0);
  for (const FarView::Part& part : view.parts) {
    double sine = 1;
    if (!same) {
      const std::array<std::uint32_t, 3>& t = triangles[part.facet];
      const glm::dvec3 normal = glm::cross(points_m[t[1]] - points_m[t[0]], points_m[t[2]] - points_m[t[0]]);
      const double length = glm::length(normal);
      sine = length > 0 ? std::min(1.0, std::abs(glm::dot(normal, towards)) / length) : 0;
    }
    const glm::dvec2 first = view.across_m[part.first];
    for (std::size_t i = 0; i < lengths.size(); ++i) {
      const double turn = -2 * wave_numbers_per_m[i];
      std::complex<double> sum = 0;
      for (std::uint32_t k = part.first + 2; k < part.first + part.count; ++k) {
        const glm::dvec2 a = view.across_m[k - 1] - first, b = view.across_m[k] - first;
        sum += (a.x * b.y - a.y * b.x) / 2 *
               mean_phasor(turn * view.towards_m[part.first], turn * view.towards_m[k - 1],
                           turn * view.towards_m[k]);
      }
      lengths[i] += same ? sum : surface.factor(sine, wave_numbers_per_m[i]) * sum;
    }
  }
  for (std::size_t i = 0; i < lengths.size(); ++i)
    lengths[i] *= std::complex<double>(0, -wave_numbers_per_m[i] / (2 * std::numbers::pi)) *
                  (same ? surface.reflection : 1.0);
  return lengths;
}

double target_strength_db(std::complex<double> length_m) {
  const double section = std::norm(length_m);
  return section > 0 ? 10 * std::log10(section) : -std::numeric_limits<double>::infinity();
}

glm::dvec3 sonar_direction(double azimuth_deg, double elevation_deg) {
  const double azimuth = azimuth_deg * degree, elevation = elevation_deg * degree;
  return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
          std::sin(elevation)};
}

}  // namespace tubefoot
