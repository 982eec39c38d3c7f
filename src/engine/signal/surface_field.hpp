// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <utility>

#include "engine/scattering/counter_random.hpp"

// Defines scene-fixed speckle: a white Gaussian scatterer field on surfaces, as a function of seed and
// lattice cell only. Source: docs/notes/signals.md, "Scatterers".

namespace tubefoot {

/// Axis that a plane faces most. The weights move the tie away from planes of 45 degrees, where rounding
/// would decide.
inline int lattice_axis(glm::dvec3 normal) {
  const glm::dvec3 size = glm::abs(normal) * glm::dvec3(1, 1.0137, 1.0291);
  return size.z >= size.x && size.z >= size.y ? 2 : size.y >= size.x ? 1 : 0;
}

/// Modulation of the seabed's cross section: a positive field of mean 1, constant over cells of the surface.
enum class SurfaceTexture {
  none,
  gamma,      ///< variance 1 / shape: K-distributed amplitudes (Jakeman & Pusey 1976)
  log_normal  ///< same variance
};

/// Scene-fixed speckle S(x): circular, complex, Gaussian and white,
///     E[S(x) S*(x')] = delta(x - x').
/// Each cell of a lattice that is fixed in the local frame has one scatterer. Its position in the cell and
/// its amplitude are functions of seed and cell only. They are the same for every sensor, time and position.
///
/// The lattice consists of squares in the coordinate plane (x-y, y-z or x-z) that a facet faces most. A
/// scatterer is projected onto the facet and represents the area spacing^2 / cos of the angle between both
/// planes. The variance per square metre is thus 1 on every slope and wall. The amplitude depends on the
/// lattice cube that contains the projected scatterer. Speckle on a deck is therefore independent of speckle
/// on the seabed below.
///
/// Law Y4 (variance): the mean over seeds of |sum of amplitude f|^2 is the integral of |f|^2 dA over the
/// polygon. It holds for every spacing and every f, because positions are uniformly distributed over their
/// cells.
/// Law Y5 (ground): a scatterer depends on the plane of its facet, not on how this plane is divided into
/// facets.
struct SurfaceField {
  std::uint64_t seed = 1;
  double spacing_m = 0.01;
  SurfaceTexture texture = SurfaceTexture::none;
  double shape = 1;             ///< positive
  double texture_cell_m = 0.1;  ///< side of the cubes over which the texture is constant

  /// Scatterers of a convex polygon on a plane. `corners_m`: in the local frame. `normal`: unit vector.
  /// Calls take(place, amplitude), where E|amplitude|^2 is an area.
  template <class Take>
  void for_scatterers(std::span<const glm::dvec3> corners_m, glm::dvec3 normal, const Take& take) const;

  /// Area that a scatterer on a plane represents.
  double area_m2(glm::dvec3 normal) const {
    return spacing_m * spacing_m / std::abs(normal[lattice_axis(normal)]);
  }
  double texture_at(glm::dvec3 place_m) const { return texture_of(texture_cell(place_m)); }

 private:
  glm::dvec3 texture_cell(glm::dvec3 place_m) const {
    return glm::floor(place_m / texture_cell_m + 0.38196601125010515);
  }
  double texture_of(glm::dvec3 cell) const;
};

/// Widest spacing with as many scatterers per square metre, on any slope, as a sensor can resolve. Their
/// number is (2 B cos / c) (2 Phi / lambda). B is the bandwidth, cos the cosine of the least grazing angle,
/// and Phi the range of look angles in rad.
double surface_spacing_m(double bandwidth_hz, double wavelength_m, double sound_speed_m_s,
                         double look_angles_rad, double grazing_cosine = 1);

/// Spacing for fully developed speckle when the whole bandwidth and all look angles are focused on one
/// point. The mean intensity depends on the positions of the scatterers in their cells. Its variance is
/// below a hundredth of its square on any slope, so E[I^2] / E[I]^2 is 2 within 0.02.
double speckle_spacing_m(double bandwidth_hz, double wavelength_m, double sound_speed_m_s,
                         double look_angles_rad, double grazing_cosine = 1);

/// Throws std::invalid_argument for spacings, shapes or cells that are not positive and finite.
void check(const SurfaceField& field);
/// Throws std::invalid_argument for places beyond the 2^31 cells of a lattice.
void check_reach(const SurfaceField& field, glm::dvec3 place_m);

template <class Take>
void SurfaceField::for_scatterers(std::span<const glm::dvec3> corners_m, glm::dvec3 normal,
                                  const Take& take) const {
  if (corners_m.size() < 3) return;
  const int up = lattice_axis(normal), x = (up + 1) % 3, y = (up + 2) % 3;
  // Range of lattice rows that the polygon covers.
  double low_y = corners_m[0][y], high_y = low_y;
  for (const glm::dvec3& c : corners_m) {
    low_y = std::min(low_y, c[y]);
    high_y = std::max(high_y, c[y]);
    check_reach(*this, c);
  }
  const double per_m = 1 / spacing_m, root_area = std::sqrt(area_m2(normal));
  // Orientation of the polygon in the lattice plane.
  double turn = 0;
  for (std::size_t k = 2; k < corners_m.size(); ++k) {
    const glm::dvec3 a = corners_m[k - 1] - corners_m[0], b = corners_m[k] - corners_m[0];
    turn += a[x] * b[y] - a[y] * b[x];
  }
  const double sign = turn < 0 ? -1 : 1;
  const std::size_t n = corners_m.size();
  glm::dvec3 texture_cell_before(HUGE_VAL);
  double root_texture = 1;
  for (auto j = std::int64_t(std::floor(low_y * per_m)); double(j) * spacing_m <= high_y; ++j) {
    // Extent of the polygon in the row.
    const double bottom = double(j) * spacing_m, top = double(j + 1) * spacing_m;
    double low_x = HUGE_VAL, high_x = -HUGE_VAL;
    for (std::size_t k = 0; k < n; ++k) {
      const glm::dvec3 &a = corners_m[k], &b = corners_m[k + 1 == n ? 0 : k + 1];
      const auto reach = [&](double at) {
        low_x = std::min(low_x, at);
        high_x = std::max(high_x, at);
      };
      if (a[y] >= bottom && a[y] <= top) reach(a[x]);
      for (const double level : {bottom, top})
        if ((a[y] < level) != (b[y] < level)) reach(a[x] + (level - a[y]) / (b[y] - a[y]) * (b[x] - a[x]));
    }
    for (auto i = std::int64_t(std::floor(low_x * per_m)); double(i) * spacing_m <= high_x; ++i) {
      const SampleRandom cell(seed, std::uint32_t(up), std::uint32_t(j), std::uint32_t(i));
      const auto [s, t] = cell.uniform_pair(Purpose::surface_place);
      glm::dvec3 place;
      place[x] = (double(i) + s) * spacing_m;
      place[y] = (double(j) + t) * spacing_m;
      bool inside = true;
      for (std::size_t k = 0; k < n && inside; ++k) {
        // Both polygons at a common edge compute the same side.
        const glm::dvec3 *a = &corners_m[k], *b = &corners_m[k + 1 == n ? 0 : k + 1];
        double side = sign;
        if ((*b)[x] < (*a)[x] || ((*b)[x] == (*a)[x] && (*b)[y] < (*a)[y])) {
          std::swap(a, b);
          side = -side;
        }
        const double cross =
            ((*b)[x] - (*a)[x]) * (place[y] - (*a)[y]) - ((*b)[y] - (*a)[y]) * (place[x] - (*a)[x]);
        inside = side > 0 ? cross >= 0 : cross < 0;
      }
      if (!inside) continue;
      const glm::dvec3& corner = corners_m[0];
      place[up] =
          corner[up] - (normal[x] * (place[x] - corner[x]) + normal[y] * (place[y] - corner[y])) / normal[up];
      // The offset keeps layer borders away from usual heights of seabeds.
      const auto layer = std::int64_t(std::floor(place[up] * per_m + 0.38196601125010515));
      const SampleRandom cube(seed ^ (std::uint64_t(up + 1) << 62), std::uint32_t(layer), std::uint32_t(j),
                              std::uint32_t(i));
      std::complex<double> amplitude = root_area * circular_normal(cube.uniform_pair(Purpose::surface_mesh));
      if (texture != SurfaceTexture::none) {
        if (const glm::dvec3 within = texture_cell(place); within != texture_cell_before) {
          texture_cell_before = within;
          root_texture = std::sqrt(texture_of(within));
        }
        amplitude *= root_texture;
      }
      take(place, amplitude);
    }
  }
}

}  // namespace tubefoot
