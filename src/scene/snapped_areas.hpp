// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "geometry/mesh/facet_mesh.hpp"

// Effect of the world grid on the areas of a scene's components. Energies are proportional to areas.
namespace tubefoot {

/// Returns the sum of the areas of all triangles.
double area_m2(const std::vector<glm::dvec3>& points_m,
               const std::vector<std::array<std::uint32_t, 3>>& triangles);
/// Returns the sum of the areas of the facets [first, last) on the grid.
double area_m2(const FacetMesh& mesh, const WorldGrid& grid, FacetId first, FacetId last);

/// Area of a component as given and on the grid.
struct SnappedArea {
  std::string name;
  double given_m2 = 0, snapped_m2 = 0;
  bool is_changed() const;  ///< by more than a thousandth
};
/// Returns a warning. `finest_exponent` is that of the finest grid that holds the scene.
std::string warning_of(const SnappedArea& area, const WorldGrid& grid, int finest_exponent);

}  // namespace tubefoot
