// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

// Meshes of the benchmark suite. Every coordinate is a multiple of 2^-10 m below 8192 m: a decimal of the OBJ
// and a float of the STL hold it in full, so whoever reads either has the scene itself.
namespace tubefoot {

struct Solid {
  std::string name, material;
  std::vector<glm::dvec3> vertices_m;
  std::vector<std::array<std::uint32_t, 3>> facets;  ///< counter-clockwise for someone outside
};

/// East-north rectangle, facing up.
Solid level_plate(const std::string& name, const std::string& material, glm::dvec3 centre_m, double width_m,
                  double length_m);
/// Upright rectangle, square to a heading (degrees, clockwise from north), facing the one who looks along it.
Solid upright_plate(const std::string& name, const std::string& material, glm::dvec3 centre_m,
                    double heading_deg, double width_m, double height_m);
/// Turned clockwise, seen from above.
Solid box(const std::string& name, const std::string& material, glm::dvec3 centre_m, glm::dvec3 size_m,
          double heading_deg);
/// Parallels and meridians.
Solid sphere(const std::string& name, const std::string& material, glm::dvec3 centre_m, double radius_m,
             int rings, int sectors);
/// All facets of `more` become `solid`'s.
void add(Solid& solid, const Solid& more);
/// Vertices to the nearest multiple of 2^-10 m.
void snap(Solid& solid);

/// Wavefront OBJ.
std::string obj_text(const Solid& solid);
/// Binary STL, little-endian.
std::string stl_bytes(const Solid& solid);

}  // namespace tubefoot
