// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "geometry/mesh/facet_mesh.hpp"

// What the world grid does to the areas of a scene's components. Energies are proportional to areas.
namespace tubefoot {

/// Sum of the areas of all triangles.
double area_m2(const std::vector<glm::dvec3>& points_m,
               const std::vector<std::array<std::uint32_t, 3>>& triangles);
/// The same of the facets [first, last) as they are on the grid.
double area_m2(const FacetMesh& mesh, const WorldGrid& grid, FacetId first, FacetId last);

/// A component's area as given and as it is on the grid.
struct SnappedArea {
  std::string name;
  double given_m2 = 0, snapped_m2 = 0;
  bool is_changed() const;  ///< by more than a thousandth
};
/// `finest_exponent`: of the finest grid that holds the scene.
std::string warning_of(const SnappedArea& area, const WorldGrid& grid, int finest_exponent);

}  // namespace tubefoot
