// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/gradient/certified_gradient.hpp"
#include "engine/visibility/tube_engine.hpp"
#include "fixtures/geometry/grid_scenes.hpp"

// Small scenes for certified derivatives and for their range of validity.
namespace tubefoot::test {

constexpr double certified_unit_m = 0x1p-22;

inline GridPoint certified_point(double x, double y, double z) {
  const auto snap = [](double m) { return std::int32_t(std::lround(m / certified_unit_m)); };
  return {snap(x), snap(y), snap(z)};
}

struct CertifiedScene {
  FacetMesh mesh;
  TubeSet tubes;
  RangeSamples samples;
  std::vector<double> mu{std::pow(10, -2.7)};
  double absorption_db_per_m = 0;

  std::vector<std::uint32_t> beam_of_tube() const {
    std::vector<std::uint32_t> beams;
    for (std::uint32_t k = 0; k < tubes.tubes.size(); ++k) beams.push_back(k);
    return beams;
  }
  History history() const {
    const SceneTree tree(mesh);
    VisibilityOptions options;
    options.corner_names = true;
    return TubeEngine(mesh, tree, certified_unit_m, options).trace(tubes);
  }
  EchoModel model() const { return {mu, mesh.material, absorption_db_per_m}; }
  CertifiedDerivatives certified(const History& history, std::span<const EchoParameter> parameters) const {
    const std::vector<std::uint32_t> beams = beam_of_tube();
    return certified_derivatives(mesh, history, {int(beams.size()), beams}, samples, model(), parameters);
  }
};

/// A terrain of few facets, and facets that intersect each other in front of it.
inline CertifiedScene few_facets(std::uint64_t seed, double absorption_db_per_m) {
  const auto units = [](double m) { return std::int32_t(m / certified_unit_m); };
  CertifiedScene scene;
  Random random(seed);
  scene.mesh = rough_terrain(random, 2, units(16), 0, units(0.6));
  const FacetMesh solids = make_random_triangles(random, 3, units(5), units(2));
  for (const auto& [a, b, c] : solids.facets) {
    add_facet(scene.mesh, add_vertex(scene.mesh, solids.vertices[a]),
              add_vertex(scene.mesh, solids.vertices[b]), add_vertex(scene.mesh, solids.vertices[c]));
    scene.mesh.component.back() = 1;
  }
  scene.tubes = forward_tubes(certified_point(0.01, 0.02, 3), 2, 1, 30, 50, 32);
  scene.samples = {2.125, 0.75, 12};
  scene.absorption_db_per_m = absorption_db_per_m;
  return scene;
}

/// Tangent of half the width of the tube in wall_before_seabed(), times 2^28.
constexpr std::int32_t certified_half_width = 1342177;

/// The scene of EchoGradient.OfTheShadowOfAWallIsTheClosedForm.
inline CertifiedScene wall_before_seabed() {
  CertifiedScene scene;
  const double wall = 0.5, distance = 4;
  scene.mesh.vertices = {certified_point(-20, -20, 0),       certified_point(20, -20, 0),
                         certified_point(20, 20, 0),         certified_point(-20, 20, 0),
                         certified_point(distance, -3, 0),   certified_point(distance, 3, 0),
                         certified_point(distance, 3, wall), certified_point(distance, -3, wall)};
  scene.mesh.facets = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}};
  scene.mesh.material = {0, 0, 0, 0};
  scene.mesh.component = {0, 0, 1, 1};
  scene.tubes.apex = certified_point(0, 0, 3);
  scene.tubes.reach = 30 / certified_unit_m;
  AngularGrid grid;
  grid.azimuth_edges_rad = {-0.005, 0.005};
  grid.elevation_edges_rad = {-1.2, -0.1};
  grid.frame = glm::dmat3(glm::dvec3(1, 0, 0), glm::dvec3(0, -1, 0), glm::dvec3(0, 0, 1));
  append_tubes(scene.tubes, grid);
  for (GridPoint& ray : scene.tubes.rays)
    ray = {1 << 28, ray.y < 0 ? -certified_half_width : certified_half_width,
           std::int32_t(std::lround((1 << 28) * (double(ray.z) / ray.x)))};
  scene.samples = {5.1875, 6 - 5.1875, 1};
  return scene;
}

}  // namespace tubefoot::test
