// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "geometry/mesh/facet_mesh.hpp"
#include "geometry/tubes/tube.hpp"

namespace tubefoot::atlas {

/// An adversarial case for visibility methods. Every tube is a parallelogram pyramid (parallelogram_tubes).
/// Its section by a plane has coordinates (u, v) in the unit square, in which area is a plain product.
struct Case {
  std::string name;   ///< name of its picture
  std::string title;  ///< title in the table
  std::string why;    ///< one sentence on the reason why methods fail
  FacetMesh mesh;
  TubeSet tubes;
  int columns = 1;         ///< number of columns and of rows of tubes; a tube has the number j * columns + i
  int grid_exponent = 20;  ///< the unit is 2^-grid_exponent m
  /// Position of the scene in metres. The kernel subtracts it; engines with absolute coordinates do not.
  glm::dvec3 origin_m{0};
};

/// Sizes of the scenes: those of the page, or small ones that take seconds in total.
enum class Size { page, quick };

/// Returns all cases. Seeds are fixed, so that the cases are always the same.
std::vector<Case> all_cases(Size size);

// cases_position.cpp: the apex and the walls in special positions
Case apex_nearly_in_planes(Size size);
Case walls_along_edges(Size size);
Case vertices_on_walls(Size size);
Case apex_on_vertex(Size size);
Case apex_on_edge(Size size);
Case apex_on_face(Size size);
Case across_the_horizon(Size size);
Case tiny_lattice(Size size);

// cases_shape.cpp: facets of difficult shape, or too close to each other
Case slivers(Size size);
Case needle_tube(Size size);
Case t_junctions(Size size);
Case coincident_facets(Size size);
Case layers_one_unit_apart(Size size);
Case thousands_of_layers(Size size);
Case whole_coordinate_range(Size size);

// cases_seabed.cpp: ordinary scenes from unfavourable positions
Case interpenetration(Size size);
Case utm_offset(Size size);
Case ecef_offset(Size size);
Case small_facets(Size size);
Case grazing_terrain(Size size);

}  // namespace tubefoot::atlas
