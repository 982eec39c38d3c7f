// SPDX-License-Identifier: GPL-3.0-or-later

// Places the facets of objects that move on trajectories, and of the sea surface.

#include "scene/moving_objects.hpp"

#include <fmt/format.h>

#include <cmath>

#include "files/input_error.hpp"
#include "geometry/mesh/weld_table.hpp"
#include "scene/scene.hpp"

namespace tubefoot {
namespace {

const ObjectDescription& description_of(const Scene& scene, const MovingObject& object) {
  return scene.description.objects[object.component - scene.description.terrains.size()];
}

std::int32_t sum_on_grid(std::int32_t origin, double offset_m, const WorldGrid& grid) {
  constexpr double reach = 1 << WorldGrid::coordinate_bits;
  const double sum = origin + std::round(std::ldexp(offset_m, grid.exponent()));  // exact below 2^53
  if (!(std::abs(sum) <= reach)) throw GridRangeError("a vertex is outside of the grid");
  return static_cast<std::int32_t>(sum);
}

void place_waves(const MovingObject& sea, const WorldGrid& grid, double time_s, GridPoint* vertex) {
  const std::vector<double> heights_m = sea.waves->heights_m(time_s);
  for (std::size_t k = 0; k < heights_m.size(); ++k)
    *vertex++ = grid.snap(sea.points_m[k] + glm::dvec3(0, 0, heights_m[k]));
}

}  // namespace

MovingObject moving_sea_surface(const ComponentMesh& mesh, std::shared_ptr<const WaveLattice> waves,
                                std::uint16_t component, std::uint16_t material) {
  MovingObject sea;
  sea.component = component;
  sea.waves = std::move(waves);
  sea.points_m = mesh.points_m;
  for (const auto& [a, b, c] : mesh.triangles) sea.shape.facets.push_back({a, b, c});
  sea.shape.material.assign(sea.shape.facets.size(), material);
  sea.shape.component.assign(sea.shape.facets.size(), component);
  return sea;
}

const MovingObject* moving_sea_surface_of(const Scene& scene) {
  return scene.moving.empty() || !scene.moving.back().waves ? nullptr : &scene.moving.back();
}

MovingObject moving_object(const ComponentMesh& mesh, const WorldGrid& grid, std::uint16_t component,
                           std::uint16_t material, MeshReport& report) {
  const WorldGrid own(grid.exponent(), glm::dvec3(0));
  MeshBuilder builder(own);
  builder.add(mesh.points_m, mesh.triangles, material, component);
  MovingObject object;
  object.component = component;
  MeshReport found;
  object.shape = builder.finish(found);
  if (!mesh.materials.empty()) object.shape.material = mesh.materials;
  report.degenerate_facets += found.degenerate_facets;
  report.duplicate_facets += found.duplicate_facets;
  report.largest_snap_m = std::max(report.largest_snap_m, found.largest_snap_m);
  WeldTable weld(object.shape.vertices);
  weld.reserve(object.shape.vertices.size());
  object.points_m.resize(object.shape.vertices.size());
  std::vector<bool> is_set(object.points_m.size());
  for (const glm::dvec3& point : mesh.points_m) {
    const VertexId vertex = weld.id_of(own.snap(point));
    if (!is_set[vertex]) object.points_m[vertex] = point;
    is_set[vertex] = true;
  }
  return object;
}

Pose pose_of(const MovingObject& object, const Trajectory& trajectory, double time_s) {
  const Pose carrier = trajectory.at(time_s);
  return {carrier.position_m + carrier.attitude * object.on_carrier.position_m,
          carrier.attitude * object.on_carrier.attitude};
}

void add_moving(const Scene& scene, double time_s, FacetMesh& mesh) {
  if (scene.moving.empty()) return;
  for (const MovingObject& object : scene.moving) {
    const auto first = static_cast<VertexId>(mesh.vertices.size());
    mesh.vertices.resize(first + object.points_m.size());
    for (const auto& [a, b, c] : object.shape.facets)
      mesh.facets.push_back({first + a, first + b, first + c});
    mesh.material.insert(mesh.material.end(), object.shape.material.begin(), object.shape.material.end());
    mesh.component.insert(mesh.component.end(), object.shape.component.begin(), object.shape.component.end());
  }
  place_moving(scene, time_s, mesh);
}

void drop_moving(const Scene& scene, FacetMesh& mesh) {
  for (const MovingObject& object : scene.moving) {
    const std::size_t left = mesh.facets.size() - object.shape.facets.size();
    mesh.facets.resize(left);
    mesh.material.resize(left);
    mesh.component.resize(left);
    mesh.vertices.resize(mesh.vertices.size() - object.points_m.size());
  }
}

FacetId first_moving_facet(const Scene& scene, const FacetMesh& mesh) {
  std::size_t first = mesh.facets.size();
  for (const MovingObject& object : scene.moving) first -= object.shape.facets.size();
  return static_cast<FacetId>(first);
}

void place_moving(const Scene& scene, double time_s, FacetMesh& mesh) {
  std::size_t vertex = mesh.vertices.size();
  for (const MovingObject& object : scene.moving) vertex -= object.points_m.size();
  for (const MovingObject& object : scene.moving) {
    const ObjectDescription& described = description_of(scene, object);
    const auto leaves_grid = [&](const GridRangeError& error) {
      return InputError(described.place,
                        fmt::format("object '{}' leaves the grid of the scene at {:.9g} s: {}; reduce "
                                    "'grid_exponent' in [run]",
                                    described.name, time_s, error.what()));
    };
    if (object.waves) try {
        place_waves(object, scene.grid, time_s, &mesh.vertices[vertex]);
        vertex += object.points_m.size();
        continue;
      } catch (const GridRangeError& error) {
        throw leaves_grid(error);
      }
    const Trajectory& trajectory = scene.trajectories[object.trajectory];
    if (!trajectory.holds(time_s))
      throw InputError(
          described.trajectory_place,
          fmt::format("a transmission is sent at {:.9g} s, but trajectory '{}' of object '{}' "
                      "lasts only from {:.9g} s to {:.9g} s: use fewer pings or a longer trajectory",
                      time_s, described.trajectory, described.name, trajectory.begin_s(),
                      trajectory.end_s()));
    const Pose pose = pose_of(object, trajectory, time_s);
    try {
      const GridPoint origin = scene.grid.snap(pose.position_m);
      for (const glm::dvec3& point : object.points_m) {
        const glm::dvec3 offset_m = pose.attitude * point;
        mesh.vertices[vertex++] = {sum_on_grid(origin.x, offset_m.x, scene.grid),
                                   sum_on_grid(origin.y, offset_m.y, scene.grid),
                                   sum_on_grid(origin.z, offset_m.z, scene.grid)};
      }
    } catch (const GridRangeError& error) {
      throw leaves_grid(error);
    }
  }
}

}  // namespace tubefoot
