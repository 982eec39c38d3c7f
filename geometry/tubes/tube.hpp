// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <optional>
#include <vector>

#include "geometry/numbers/world_grid.hpp"

namespace tubefoot {

/// A pyramid of four rays from one apex, as indices into TubeSet::rays. In their order ray[k] x ray[k+1] is
/// the inward normal of wall k. This is counter-clockwise for an observer who looks back at the apex. The
/// walls are planes.
using Tube = std::array<std::uint32_t, 4>;

/// All tubes of one ping. They share the apex, and neighbours share rays, so that they partition their
/// sector.
struct TubeSet {
  GridPoint apex;
  /// Ray directions as integer vectors, |coordinate| <= 2^30. Rounding a unit vector costs about 1e-9 rad.
  std::vector<GridPoint> rays;
  std::vector<Tube> tubes;
  /// Facets that lie wholly beyond this distance from the apex are ignored. Grid units.
  double reach = 0;

  friend bool operator==(const TubeSet&, const TubeSet&) = default;
};

inline std::array<GridPoint, 4> rays_of(const TubeSet& set, std::uint32_t tube) {
  const Tube& t = set.tubes.at(tube);
  return {set.rays[t[0]], set.rays[t[1]], set.rays[t[2]], set.rays[t[3]]};
}

/// A sector in two angles, divided into a grid of tubes. The azimuth is measured about `axis`, and the
/// elevation from the plane perpendicular to the axis. Walls of constant azimuth are planes that contain the
/// axis. Walls of constant elevation are replaced by the planes through neighbouring corner rays.
struct AngularGrid {
  /// Edges in increasing order, radians; n+1 edges make n cells. Azimuth cells < pi, |elevation| < pi/2.
  std::vector<double> azimuth_edges_rad;
  std::vector<double> elevation_edges_rad;
  /// Columns: the directions of (azimuth 0, elevation 0), of azimuth +90 degrees, and of the axis, in the
  /// local frame. The frame is orthonormal and may be left- or right-handed. Tubes are counter-clockwise in
  /// both cases.
  glm::dmat3 frame{1.0};
};

/// Returns the unit vector of the two angles in the grid's frame.
glm::dvec3 direction(const AngularGrid& grid, double azimuth_rad, double elevation_rad);

/// Rounds a unit vector to an integer ray.
///
/// Law B1 (rays): each coordinate is rounded to the nearest integer and does not exceed 2^30.
GridPoint integer_ray(glm::dvec3 unit_direction);

/// Appends the grid's tubes to `set`. Tube (i, j) for azimuth cell i and elevation cell j has the number
/// first + i * elevation_cells + j. Returns `first`. Throws std::invalid_argument for edges that do not
/// increase, or for a cell that is too wide.
///
/// Law B2 (partition): neighbours share rays, a full turn has no seam, and the solid angles add up to that of
/// the sector.
///
/// Law B3 (pyramids): the other rays of a tube lie strictly inside each of its walls, in frames of either
/// handedness.
std::uint32_t append_tubes(TubeSet& set, const AngularGrid& grid);

/// Returns the rays of a pyramid that contains tubes [first, end) of a set, in the order of a tube's rays.
/// Its first wall runs along the row of tubes. The result is empty if the tubes are too far apart for such a
/// pyramid.
///
/// Law B5 (enclosure): all rays of these tubes lie strictly inside each wall of the pyramid.
std::optional<std::array<GridPoint, 4>> enclosing_pyramid(const TubeSet& set, std::uint32_t first,
                                                          std::uint32_t end);

}  // namespace tubefoot
