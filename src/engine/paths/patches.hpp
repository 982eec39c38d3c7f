// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "engine/paths/visible_surface.hpp"

// Divides the surface that an apex sees into patches that are small enough to act as points. Source:
// docs/notes/multiple-paths.md, "Several scatterings".
namespace tubefoot {

/// Triangles of footprints that lie close together on one facet.
struct RadiosityPatch {
  FacetId facet = 0;
  std::array<std::int64_t, 3> cube{};
  std::uint32_t tube = 0;     ///< one of the apex's tubes that see the patch
  glm::dvec3 from_apex_m{0};  ///< apparent position of the centre
  glm::dvec3 lies_m{0};       ///< true position of the centre, also from the apex
  glm::dvec3 normal{0};       ///< unit normal at the true position, on the visible side
  double sine = 0;            ///< sine of the grazing angle at the centre
  double absorbed = 1;        ///< loss factor of the path to the patch, relative to the apparent range
  double area_m2 = 0;
  double solid_angle_sr = 0;  ///< as seen from the apex
  double projected_sr = 0;    ///< with an axis: solid angle weighted by the cosine to the axis
};

/// Cuts the surface that an apex sees at the middles of longest edges until no edge is longer than
/// `longest_m`. The triangles of one facet become one patch if their centres lie in the same cube and their
/// tubes have the same label. The edge of a cube is `longest_m` / 2. Cubes begin at the least coordinates of
/// the facet, so they do not depend on the apex. Empty labels mean one label for all tubes. `axis`: unit
/// vector for RadiosityPatch::projected_sr, or 0; the visible surface must lie on its side. Throws
/// std::length_error for more than 1e8 patches.
std::vector<RadiosityPatch> patches_of(const FacetMesh& mesh, GridPoint apex, const VisibleSurface& seabed,
                                       double unit_m, double longest_m,
                                       std::span<const std::uint32_t> label_of_tube,
                                       glm::dvec3 axis = glm::dvec3(0));

/// Grid point next to a place on a facet (in grid units from `apex`), on the side of the facet's plane that
/// `normal` points to. Its distance from the plane is at least `least` units.
GridPoint in_front(const FacetMesh& mesh, FacetId facet, GridPoint apex, glm::dvec3 place, glm::dvec3 normal,
                   double least = 0);

/// Tubes from a point that cover the side of a plane to which `normal` points. Caps of 1e-3 rad about an
/// axis in the plane are not covered.
TubeSet front_tubes(GridPoint from, glm::dvec3 normal, double reach);

}  // namespace tubefoot
