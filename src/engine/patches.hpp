// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "geometry/shared_footprints.hpp"

// What an apex sees, in pieces small enough to be taken for points. docs/paths.md
namespace tubefoot {

/// Some triangles of footprints, close together on a facet.
struct Patch {
  FacetId facet = 0;
  std::uint32_t tube = 0;       ///< one of the apex's that see it
  GridPoint centre;             ///< rounded to the grid, on the apex's side of the facet's plane
  glm::dvec3 from_apex_m{0};    ///< the centre, not rounded
  glm::dvec3 normal{0};         ///< unit, to the apex's side
  double plane_distance_m = 0;  ///< of the apex
  double area_m2 = 0;
};

/// All that an apex sees (shared_with_itself()), cut at the middles of longest edges until none is longer
/// than `longest_m`; then those of a facet whose middles lie in the same cube of half that edge, and whose
/// tubes have the same label, are one. Labels may be empty: all tubes have the same. Throws std::length_error
/// if that would be more than a hundred million patches.
std::vector<Patch> patches_of(const FacetMesh& mesh, GridPoint apex, const SharedFootprints& seen,
                              double unit_m, double longest_m, std::span<const std::uint32_t> label_of_tube);

/// Tubes that look from a patch to its whole front side, but for caps of 1e-3 rad about an axis in its plane.
TubeSet front_tubes(const Patch& patch, double reach);

}  // namespace tubefoot
