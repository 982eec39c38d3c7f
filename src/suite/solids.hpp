// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

// Meshes of the benchmark suite. Every coordinate is a multiple of 2^-10 m below 8192 m. OBJ decimals and
// STL floats represent such coordinates exactly, so that readers of both formats get the same scene.
namespace tubefoot {

struct Solid {
  std::string name, material;
  std::vector<glm::dvec3> vertices_m;
  std::vector<std::array<std::uint32_t, 3>> facets;  ///< counter-clockwise as seen from outside
  std::string more{};                                ///< further keys of the object in the scene file
};

/// Returns a rectangle with horizontal sides to the east and north, facing up.
Solid level_plate(const std::string& name, const std::string& material, glm::dvec3 centre_m, double width_m,
                  double length_m);
/// Returns an upright rectangle perpendicular to a heading (degrees, clockwise from north). Its front faces
/// a viewer who looks along the heading.
Solid upright_plate(const std::string& name, const std::string& material, glm::dvec3 centre_m,
                    double heading_deg, double width_m, double height_m);
/// Returns a box that is turned clockwise as seen from above.
Solid box(const std::string& name, const std::string& material, glm::dvec3 centre_m, glm::dvec3 size_m,
          double heading_deg);
/// Returns a sphere whose facets lie between parallels and meridians.
Solid sphere(const std::string& name, const std::string& material, glm::dvec3 centre_m, double radius_m,
             int rings, int sectors);
/// Appends all facets of `more` to `solid`.
void add(Solid& solid, const Solid& more);
/// Rounds the vertices to the nearest multiple of 2^-10 m.
void snap(Solid& solid);

/// Returns the solid as Wavefront OBJ.
std::string obj_text(const Solid& solid);
/// Returns the solid as binary STL, little-endian.
std::string stl_bytes(const Solid& solid);

}  // namespace tubefoot
