// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/scene_placement.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <glm/trigonometric.hpp>
#include <limits>
#include <vector>

namespace tubefoot {
namespace {

glm::dvec3 position_of(const ObjectDescription& object, const LocalFrame& frame) {
  const auto [east, north, up] = object.position_m;
  if (!object.position_lat_lon_deg) return {east, north, up};
  const auto [latitude, longitude] = *object.position_lat_lon_deg;
  glm::dvec3 point(longitude, latitude, up);
  place_by_lon_lat(
      {&point, 1}, frame, object.place,
      "position_lat_lon_deg needs a [georeference], which the scene does not have: add one, or give "
      "position_m");
  return point;
}

glm::dquat attitude_of(const ObjectDescription& object) {
  return attitude_from_angles(glm::radians(object.heading_deg), glm::radians(object.pitch_deg),
                              glm::radians(object.roll_deg));
}

glm::dvec3 scale_of(const ObjectDescription& object) {
  return {object.scale[0], object.scale[1], object.scale[2]};
}

}  // namespace

void place_by_lon_lat(std::span<glm::dvec3> points, const LocalFrame& frame, const SourcePlace& place,
                      const char* without_frame) {
  if (!frame.is_georeferenced()) throw InputError(place, without_frame);
  // Away from the origin of a tangent frame, the vertical is not the local up direction. A second step
  // corrects the height, so that the point has the given local height.
  std::vector<glm::dvec3> level(points.begin(), points.end());
  for (glm::dvec3& p : level) p.z = 0;
  frame.from_lon_lat(level, place);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const double up = points[k].z;
    points[k].z = up - level[k].z;
    level[k].z = up;
  }
  frame.from_lon_lat(points, place);
  for (std::size_t k = 0; k < points.size(); ++k) points[k].z = level[k].z;
}

Pose place_object(ComponentMesh& mesh, const ObjectDescription& object, const LocalFrame& frame,
                  const std::function<std::optional<double>(double, double)>& height_m,
                  const std::function<std::string()>& extent) {
  glm::dvec3 position = position_of(object, frame);
  const glm::dquat attitude = attitude_of(object);
  const glm::dvec3 scale = scale_of(object);
  double lowest = std::numeric_limits<double>::infinity();
  for (glm::dvec3& p : mesh.points_m) {
    p = position + attitude * (scale * p);
    lowest = std::min(lowest, p.z);
  }
  if (object.on_terrain_m) {
    const auto surface_mesh = height_m(position.x, position.y);
    if (!surface_mesh) {
      throw InputError(
          object.place,
          fmt::format("on_terrain_m: there is no terrain below the object's position ({:.3f} m east, {:.3f} "
                      "m north); the terrain covers {}: move the object, or give the height in position_m",
                      position.x, position.y, extent()));
    }
    const double shift = *surface_mesh + *object.on_terrain_m - lowest;
    for (glm::dvec3& p : mesh.points_m) p.z += shift;
    position.z += shift;
  }
  return {position, attitude};
}

Pose scaled_for_carrier(ComponentMesh& mesh, const ObjectDescription& object) {
  for (glm::dvec3& p : mesh.points_m) p = scale_of(object) * p;
  const auto [starboard, forward, up] = object.position_m;
  return {{starboard, forward, up}, attitude_of(object)};
}

}  // namespace tubefoot
