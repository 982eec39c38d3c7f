// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <vector>

#include "geometry/numbers/world_grid.hpp"

namespace tubefoot {

/// Four rays from one apex, as indices into TubeSet::rays, in the order that makes ray[k] x ray[k+1] the
/// inward normal of wall k (counter-clockwise for someone who looks back at the apex). A pyramid: its walls
/// are planes.
using Tube = std::array<std::uint32_t, 4>;

/// All tubes of one ping: they share the apex, and neighbours share rays, so that they partition their
/// sector.
struct TubeSet {
  GridPoint apex;
  /// Ray directions as integer vectors, |coordinate| <= 2^30; rounding a unit vector costs about 1e-9 rad.
  std::vector<GridPoint> rays;
  std::vector<Tube> tubes;
  /// Facets that lie wholly beyond this distance from the apex are not looked at. Grid units.
  double reach = 0;

  friend bool operator==(const TubeSet&, const TubeSet&) = default;
};

/// A sector in the angles (azimuth about `axis`, elevation from the plane perpendicular to it), cut into a
/// grid of tubes. Walls of constant azimuth are planes that contain the axis; walls of constant elevation are
/// replaced by the planes through neighbouring corner rays.
struct AngularGrid {
  /// Edges in increasing order, radians; n+1 edges make n cells. Azimuth cells < pi, |elevation| < pi/2.
  std::vector<double> azimuth_edges_rad;
  std::vector<double> elevation_edges_rad;
  /// Columns: the directions of (azimuth 0, elevation 0), of azimuth +90 degrees, and of the axis,
  /// in the local frame. Orthonormal. May be left- or right-handed: tubes come out counter-clockwise either
  /// way.
  glm::dmat3 frame{1.0};
};

/// Unit vector of the two angles in the grid's frame.
glm::dvec3 direction(const AngularGrid& grid, double azimuth_rad, double elevation_rad);

/// Rounds a unit vector to an integer ray.
/// Law B1 (rays): each coordinate to the nearest, none beyond 2^30.
GridPoint integer_ray(glm::dvec3 unit_direction);

/// Appends the grid's tubes to `set`, azimuth-major: tube (i, j) is at first + i * elevation_cells + j.
/// Returns `first`. Throws std::invalid_argument for edges that do not increase or a cell too wide.
/// Law B2 (partition): neighbours share rays, a full turn has no seam, solid angles add up to the sector's.
/// Law B3 (pyramids): every wall has the tube's other rays strictly inside, in frames of either handedness.
std::uint32_t append_tubes(TubeSet& set, const AngularGrid& grid);

}  // namespace tubefoot
