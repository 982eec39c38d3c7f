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

namespace tubefoot {

/// The axis that a plane faces most. Weights keep planes of 45 degrees off the tie, which rounding would
/// decide.
inline int lattice_axis(glm::dvec3 normal) {
  const glm::dvec3 size = glm::abs(normal) * glm::dvec3(1, 1.0137, 1.0291);
  return size.z >= size.x && size.z >= size.y ? 2 : size.y >= size.x ? 1 : 0;
}

/// Modulation of the seabed's cross-section: a positive field of mean 1, even over cells of the surface.
enum class SurfaceTexture {
  none,
  gamma,      ///< variance 1 / shape: amplitudes K-distributed (Jakeman & Pusey 1976)
  log_normal  ///< of the same variance
};

/// Speckle that belongs to the surface: S(x), circular, complex, Gaussian and white,
///     E[S(x) S*(x')] = delta(x - x'),
/// as one scatterer in each cell of a lattice that is fixed in the local frame. Its place in the cell and its
/// amplitude are functions of seed and cell alone: whoever looks, whenever and from wherever, sees the same.
///
/// The lattice is one of squares in that plane of the frame (of x and y, y and z, x and z) which a facet
/// faces most; a scatterer there is lifted onto the facet and stands for the area spacing^2 over the cosine
/// between the two, so that the variance a square metre is 1 on every slope and on walls. Its amplitude is of
/// the cube of the lattice that it is lifted into, so that a deck has another one than the seabed below.
///
/// Law Y4 (variance): the mean over seeds of |sum of amplitude f|^2 is the integral of |f|^2 dA over the
/// polygon, for every spacing and every f: places are even over their cells.
/// Law Y5 (ground): a scatterer depends on the plane of its facet, not on how the plane is cut into facets.
struct SurfaceField {
  std::uint64_t seed = 1;
  double spacing_m = 0.01;
  SurfaceTexture texture = SurfaceTexture::none;
  double shape = 1;             ///< above 0
  double texture_cell_m = 0.1;  ///< side of the cubes over which the texture is even

  /// Scatterers of a convex polygon on a plane; corners in the local frame, `normal` unit.
  /// Calls take(place, amplitude), E|amplitude|^2 being an area.
  template <class Take>
  void for_scatterers(std::span<const glm::dvec3> corners_m, glm::dvec3 normal, const Take& take) const;

  /// That a scatterer stands for on a plane.
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

/// The widest spacing whose scatterers are as many a square metre, on any slope, as a sensor can tell apart:
/// (2 B cos / c) (2 Phi / lambda), B the bandwidth, cos of the least grazing angle, Phi the range of look
/// angles [rad].
double surface_spacing_m(double bandwidth_hz, double wavelength_m, double sound_speed_m_s,
                         double look_angles_rad, double grazing_cosine = 1);

/// A spacing whose speckle is as it should be where all of a bandwidth and all look angles are brought to one
/// focus: there the mean intensity, which depends on where scatterers are in their cells, varies by less than
/// a hundredth of its square, on any slope, so that E[I^2] / E[I]^2 is 2 to 0.02.
double speckle_spacing_m(double bandwidth_hz, double wavelength_m, double sound_speed_m_s,
                         double look_angles_rad, double grazing_cosine = 1);

/// Throws std::invalid_argument for spacings, shapes or cells that are not above 0, or not finite.
void check(const SurfaceField& field);
/// For places so far away that lattices of 2^31 cells do not reach them.
void check_reach(const SurfaceField& field, glm::dvec3 place_m);

template <class Take>
void SurfaceField::for_scatterers(std::span<const glm::dvec3> corners_m, glm::dvec3 normal,
                                  const Take& take) const {
  if (corners_m.size() < 3) return;
  const int up = lattice_axis(normal), x = (up + 1) % 3, y = (up + 2) % 3;
  // By rows of the lattice: where the polygon's edges are.
  double low_y = corners_m[0][y], high_y = low_y;
  for (const glm::dvec3& c : corners_m) {
    low_y = std::min(low_y, c[y]);
    high_y = std::max(high_y, c[y]);
    check_reach(*this, c);
  }
  const double per_m = 1 / spacing_m, root_area = std::sqrt(area_m2(normal));
  // The polygon turns as its normal faces.
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
    // The polygon's extent in the row.
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
        // Of an edge two polygons share, both see the same side.
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
      // Layers end at no height that seabeds are built at.
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
