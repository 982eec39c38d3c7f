// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "geometry/footprints/footprint.hpp"
#include "geometry/tubes/tube.hpp"

namespace tubefoot {

/// A sampling engine's element: one ray's hit, standing for the solid angle it was drawn from.
struct RayHit {
  FacetId facet = 0;
  std::uint32_t tube = 0;
  double slant_range_m = 0;
  double sine_grazing = 0;    ///< of the grazing angle between ray and facet
  double solid_angle_sr = 0;  ///< weight: the hit stands for an area solid_angle * range^2 / sine_grazing
  glm::vec3 direction{0};     ///< of the ray, unit, in the local frame; read by beam patterns
};

/// What one transmission met, seen from one apex: the value that every sensor reads. It knows facets, tubes
/// and geometry, no sound and no sensor. A path is apex -> facet -> apex, so a footprint (or a hit) is a
/// path.
struct History {
  TubeSet tubes;
  double grid_unit_m = 1;    ///< metres per grid unit of `tubes`
  FootprintSet footprints;   ///< filled by the tube engine
  std::vector<RayHit> hits;  ///< filled by the ray engine
};

}  // namespace tubefoot
