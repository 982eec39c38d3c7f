// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "geometry/mesh/facet_mesh.hpp"
#include "geometry/tubes/tube.hpp"

namespace tubefoot::atlas {

/// One input that methods fail on. Every tube is a parallelogram pyramid (parallelogram_tubes), so that its
/// section by a plane has coordinates (u, v) in the unit square, in which area is a plain product.
struct Case {
  std::string name;   ///< of its picture
  std::string title;  ///< in the table
  std::string why;    ///< why methods fail there, one sentence
  FacetMesh mesh;
  TubeSet tubes;
  int columns = 1;         ///< of tubes, and as many rows: number j * columns + i
  int grid_exponent = 20;  ///< the unit is 2^-grid_exponent m
  /// Where the scene lies, metres. The kernel subtracts it; engines that keep absolute coordinates do not.
  glm::dvec3 origin_m{0};
};

/// Sizes of the scenes: those of the page, or small ones that take seconds in all.
enum class Size { page, quick };

/// Every case, always the same: seeds are fixed.
std::vector<Case> all_cases(Size size);

// cases_position.cpp: the apex and the walls in special position
Case apex_nearly_in_planes(Size size);
Case walls_along_edges(Size size);
Case vertices_on_walls(Size size);
Case apex_on_vertex(Size size);
Case apex_on_edge(Size size);
Case apex_on_face(Size size);
Case across_the_horizon(Size size);
Case tiny_lattice(Size size);

// cases_shape.cpp: facets of awkward shape, or too close to each other
Case slivers(Size size);
Case needle_tube(Size size);
Case t_junctions(Size size);
Case coincident_facets(Size size);
Case layers_one_unit_apart(Size size);
Case thousands_of_layers(Size size);
Case whole_coordinate_range(Size size);

// cases_seabed.cpp: ordinary scenes, seen from where it hurts
Case interpenetration(Size size);
Case utm_offset(Size size);
Case ecef_offset(Size size);
Case small_facets(Size size);
Case grazing_terrain(Size size);

}  // namespace tubefoot::atlas
