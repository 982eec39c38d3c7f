// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "engine/rays/ray_engine.hpp"
#include "geometry/mesh/facet_mesh.hpp"
#include "geometry/tubes/tube.hpp"

// Pyramids, beds and statistics for the tests of the sampling engine.
namespace tubefoot {

inline constexpr double pi = std::numbers::pi;
inline constexpr double degree = pi / 180;
inline const WorldGrid grid(20, glm::dvec3(0));

inline RaySettings stratified(std::int64_t rays, std::uint64_t seed) {
  return {RaySampling::stratified, rays, RaySettings::Per::ping, seed};
}

inline GridPoint ray_towards(glm::dvec3 v) {
  v = glm::normalize(v) * 0x1p30;
  return {std::int32_t(std::lround(v.x)), std::int32_t(std::lround(v.y)), std::int32_t(std::lround(v.z))};
}

inline glm::dvec3 as_vector(GridPoint p) { return {p.x, p.y, p.z}; }

/// A pyramid about `axis` with its corner rays at the given half-angles; counter-clockwise for someone who
/// looks back.
inline TubeSet pyramid(glm::dvec3 apex_m, glm::dvec3 axis, double half_width, double half_height,
                       double reach_m = 1000) {
  TubeSet set;
  set.apex = grid.snap(apex_m);
  set.reach = reach_m / grid.unit_m();
  axis = glm::normalize(axis);
  const glm::dvec3 side =
      glm::normalize(glm::cross(axis, std::abs(axis.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0)));
  const glm::dvec3 up = glm::cross(axis, side);
  const double w = std::tan(half_width), h = std::tan(half_height);
  for (const auto& [s, u] : {std::pair{-w, -h}, {w, -h}, {w, h}, {-w, h}})
    set.rays.push_back(ray_towards(axis + s * side + u * up));
  set.tubes = {{0, 1, 2, 3}};
  return set;
}

inline double corner_solid_angle(const TubeSet& set, const Tube& tube) {
  double sum = 0;
  for (const int k : {1, 2}) {
    const glm::dvec3 a = glm::normalize(as_vector(set.rays[tube[0]])),
                     b = glm::normalize(as_vector(set.rays[tube[k]])),
                     c = glm::normalize(as_vector(set.rays[tube[k + 1]]));
    sum +=
        2 * std::atan2(glm::dot(a, glm::cross(b, c)), 1 + glm::dot(a, b) + glm::dot(b, c) + glm::dot(c, a));
  }
  return sum;
}

inline void add_facet(FacetMesh& mesh, glm::dvec3 a, glm::dvec3 b, glm::dvec3 c) {
  const auto first = VertexId(mesh.vertices.size());
  for (const glm::dvec3& p : {a, b, c}) mesh.vertices.push_back(grid.snap(p));
  mesh.facets.push_back({first, first + 1, first + 2});
  mesh.material.push_back(0);
  mesh.component.push_back(0);
}

inline void add_rectangle(FacetMesh& mesh, glm::dvec3 corner, glm::dvec3 a, glm::dvec3 b) {
  add_facet(mesh, corner, corner + a, corner + a + b);
  add_facet(mesh, corner, corner + a + b, corner + b);
}

inline FacetMesh flat_bed(double depth_m, double half_m = 200) {
  FacetMesh mesh;
  add_rectangle(mesh, {-half_m, -half_m, -depth_m}, {2 * half_m, 0, 0}, {0, 2 * half_m, 0});
  return mesh;
}

struct Statistics {
  double sum = 0, squares = 0;
  int count = 0;
  void add(double x) {
    sum += x;
    squares += x * x;
    ++count;
  }
  double mean() const { return sum / count; }
  double sigma_of_mean() const {
    return std::sqrt(std::max(squares / count - mean() * mean(), 0.0) / (count - 1));
  }
};

}  // namespace tubefoot
