// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <glm/vec3.hpp>
#include <numbers>
#include <numeric>
#include <vector>

#include "engine/echo/echo.hpp"
#include "geometry/scenes_for_tests.hpp"

// Small scenes in metres, on a grid of 2^-20 m about the origin, for tests of paths.
namespace tubefoot::test {

constexpr double pi = std::numbers::pi, unit = 1.0 / (1 << 20);

inline GridPoint at(glm::dvec3 p) {
  p /= unit;
  return {std::int32_t(std::lround(p.x)), std::int32_t(std::lround(p.y)), std::int32_t(std::lround(p.z))};
}

inline glm::dvec3 metres(GridPoint p) { return glm::dvec3(p.x, p.y, p.z) * unit; }

inline double total(const Echo& echo) { return std::accumulate(echo.energy.begin(), echo.energy.end(), 0.0); }

inline void add_triangle(FacetMesh& mesh, glm::dvec3 a, glm::dvec3 b, glm::dvec3 c,
                         std::uint16_t material = 0) {
  const VertexId i = add_vertex(mesh, at(a)), j = add_vertex(mesh, at(b)), k = add_vertex(mesh, at(c));
  add_facet(mesh, i, j, k);
  mesh.material.back() = material;
}

inline void add_quad(FacetMesh& mesh, glm::dvec3 a, glm::dvec3 b, glm::dvec3 c, glm::dvec3 d,
                     std::uint16_t material = 0) {
  add_triangle(mesh, a, b, c, material);
  add_triangle(mesh, a, c, d, material);
}

/// Edges of `cells` even steps, in radians.
inline std::vector<double> steps(double from_deg, double to_deg, int cells) {
  std::vector<double> edges;
  for (int k = 0; k <= cells; ++k) edges.push_back((from_deg + (to_deg - from_deg) * k / cells) * pi / 180);
  return edges;
}

}  // namespace tubefoot::test
