// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "engine/paths/visible_surface.hpp"

// What an apex sees, in pieces small enough to be taken for points. docs/paths.md
namespace tubefoot {

/// Some triangles of footprints, close together on a facet.
struct RadiosityPatch {
  FacetId facet = 0;
  std::array<std::int64_t, 3> cube{};
  std::uint32_t tube = 0;     ///< one of the apex's that see it
  glm::dvec3 from_apex_m{0};  ///< its centre, as it is seen
  glm::dvec3 lies_m{0};       ///< and where that lies, from the apex too
  glm::dvec3 normal{0};       ///< unit, where it lies, to the side that is seen
  double sine = 0;            ///< of the grazing angle at the centre
  double absorbed = 1;        ///< of the way there, beyond what the apparent range makes of it
  double area_m2 = 0;
  double solid_angle_sr = 0;  ///< from the apex
  double projected_sr = 0;    ///< if asked for: its solid angle, weighed by the cosine to an axis
};

/// All that an apex sees, cut at the middles of longest edges until none is longer
/// than `longest_m`; then those of a facet whose middles lie in the same cube of half that edge, and whose
/// tubes have the same label, are one. Cubes begin at the facet's least coordinates, so that they are the
/// same from wherever it is seen. Labels may be empty: all tubes have the same. Throws std::length_error if
/// that would be more than a hundred million patches. `axis` (unit, or 0): that of Patch::projected_sr; all
/// that is seen lies on its side.
std::vector<RadiosityPatch> patches_of(const FacetMesh& mesh, GridPoint apex, const VisibleSurface& seabed,
                                       double unit_m, double longest_m,
                                       std::span<const std::uint32_t> label_of_tube,
                                       glm::dvec3 axis = glm::dvec3(0));

/// The grid point next to a place on a facet (grid units from `apex`) that is on the side of its plane that
/// `normal` points to, and no nearer to that than `least` units.
GridPoint in_front(const FacetMesh& mesh, FacetId facet, GridPoint apex, glm::dvec3 place, glm::dvec3 normal,
                   double least = 0);

/// Tubes that look from a point to the whole side of a plane that `normal` points to, but for caps of 1e-3
/// rad about an axis in it.
TubeSet front_tubes(GridPoint from, glm::dvec3 normal, double reach);

}  // namespace tubefoot
