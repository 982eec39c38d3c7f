// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <filesystem>
#include <glm/vec3.hpp>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "geometry/mesh/facet_cone.hpp"
#include "layered_scenes_for_tests.hpp"
#include "scene/meshes/mesh_file.hpp"

// Connected surfaces, solids and real meshes, seen so narrowly that slow oracles can follow.
namespace tubefoot::test {

/// The facets that may meet a tube: no wall of it has all three vertices outside.
inline FacetMesh facets_near(const FacetMesh& mesh, const TubeSet& tubes, std::uint32_t tube) {
  FacetMesh near;
  std::map<VertexId, VertexId> kept;
  for (const auto& facet : mesh.facets) {
    bool meets = true;
    for (int k = 0; k < 4 && meets; ++k) {
      const Vec64 wall = cross(tubes.rays[tubes.tubes[tube][k]], tubes.rays[tubes.tubes[tube][(k + 1) % 4]]);
      meets = false;
      for (const VertexId v : facet) meets = meets || dot(wall, mesh.vertices[v] - tubes.apex) > 0;
    }
    if (!meets) continue;
    std::array<VertexId, 3> ids{};
    for (int k = 0; k < 3; ++k) {
      const auto [place, is_new] = kept.try_emplace(facet[k], 0);
      if (is_new) place->second = add_vertex(near, mesh.vertices[facet[k]]);
      ids[k] = place->second;
    }
    add_facet(near, ids[0], ids[1], ids[2]);
  }
  return near;
}

/// A mesh towards one of its vertices, from `distance` away and above by `tilt_deg`, through one tube, as
/// wide as leaves at most `most_facets` facets, and at most 60 degrees; without the others.
inline Scene view_of_a_vertex(Random& random, const char* name, const FacetMesh& mesh, double distance,
                              double tilt_deg, std::size_t most_facets) {
  const double tilt = tilt_deg * std::acos(-1.0) / 180;
  for (;;) {
    const GridPoint aim = mesh.vertices[random() % mesh.vertices.size()];
    const GridPoint apex{aim.x, aim.y - static_cast<std::int32_t>(distance * std::cos(tilt)),
                         aim.z + static_cast<std::int32_t>(distance * std::sin(tilt))};
    // Some vertices have more facets than that, or very many behind them: on to another one.
    for (double width_deg = 60; width_deg > 0.1; width_deg *= 0.8) {
      TubeSet tubes = forward_tubes(apex, 1, 1, width_deg, 0.7 * width_deg, tilt_deg);
      FacetMesh near = facets_near(mesh, tubes, 0);
      if (near.facets.size() <= most_facets) return {name, std::move(near), std::move(tubes)};
    }
  }
}

/// A mesh of the shared data, z up, in grid units of 2^-20 m; without facets if there is no such file.
inline FacetMesh real_mesh(const std::string& file, double scale) {
  const std::filesystem::path path = std::filesystem::path(TUBEFOOT_SHARED_DATA) / file;
  if (!std::filesystem::exists(path)) return {};
  ComponentMesh read = read_mesh_file(path);
  for (glm::dvec3& p : read.points_m) p = scale * glm::dvec3(p.x, -p.z, p.y);
  MeshBuilder builder(WorldGrid(WorldGrid::finest_exponent, glm::dvec3(0)));
  builder.add(read.points_m, read.triangles, 0, 0);
  MeshReport report;
  return builder.finish(report);
}

struct RealMesh {
  const char* name;
  const char* file;
  double scale, distance_m, tilt_deg;
};
/// A panel with inner faces and coincident edges, and two real beds, from where a sonar may look at them.
inline constexpr RealMesh real_meshes[] = {{"panel of a wellhead", "bop_panel.obj", 4, 3, 10},
                                           {"bottom of a lake", "lake_bottom.obj", 1, 60, 20},
                                           {"seabed off Munkholmen", "munkholmen_seabed.obj", 0.5, 150, 25}};

/// A view of each real mesh; none where the shared data are absent.
inline std::vector<Scene> real_views(std::uint64_t seed, std::size_t most_facets) {
  static const std::vector<FacetMesh> meshes = [] {
    std::vector<FacetMesh> loaded;
    for (const RealMesh& mesh : real_meshes) loaded.push_back(real_mesh(mesh.file, mesh.scale));
    return loaded;
  }();
  Random random(seed);
  std::vector<Scene> views;
  for (std::size_t k = 0; k < meshes.size(); ++k)
    if (!meshes[k].facets.empty())
      views.push_back(view_of_a_vertex(random, real_meshes[k].name, meshes[k],
                                       std::ldexp(real_meshes[k].distance_m, WorldGrid::finest_exponent),
                                       real_meshes[k].tilt_deg, most_facets));
  return views;
}

/// Closed solids, solids and beds through each other, terrain, and the real meshes, all ahead of the apex.
inline std::vector<Scene> small_views(std::uint64_t seed, std::size_t most_facets) {
  Random random(seed);
  const auto number = [&](int lo, int hi) { return uniform(random, lo, hi); };
  std::vector<Scene> views;
  const auto add = [&](const char* name, const FacetMesh& mesh, double distance, double tilt_deg) {
    views.push_back(view_of_a_vertex(random, name, mesh, distance, tilt_deg, most_facets));
  };
  FacetMesh solid;
  add_sphere(solid, {0, 0, 0}, 90000, 2);
  add("closed solid", solid, 300000, number(0, 30));
  FacetMesh crossing = solid;
  add_box(crossing, {number(-40000, 40000), number(-40000, 40000), number(-40000, 40000)}, 70000);
  add_sphere(crossing, {number(-60000, 60000), number(-60000, 60000), number(-60000, 60000)}, 80000, 2);
  add("solids through each other", crossing, 300000, number(0, 30));
  const FacetMesh bed = rough_terrain(random, 12, 20000000, 0, 500000);
  add("terrain", bed, 30000000, number(15, 40));
  FacetMesh sunk = bed;
  add_sheet(sunk, 12, 12, [&](int u, int v) {
    return GridPoint{(u - 6) * 1600000 + 77, v * 1700000, (u + v - 12) * 20000 + number(-300000, 300000)};
  });
  add_box(sunk, {number(-5000000, 5000000), number(5000000, 15000000), 0}, 2000000);
  add("box sunk in beds that cross", sunk, 30000000, number(15, 40));
  for (Scene& view : real_views(seed, most_facets)) views.push_back(std::move(view));
  return views;
}

}  // namespace tubefoot::test
