// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/scene_placement.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <glm/trigonometric.hpp>
#include <limits>

#include "scene/trajectory.hpp"

namespace tubefoot {
namespace {

// Height of a triangle above a place; nothing where it does not reach or stands upright.
std::optional<double> height_of(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, double x,
                                double y) {
  const auto turn = [x, y](const glm::dvec3& p, const glm::dvec3& q) {
    return (p.x - x) * (q.y - y) - (p.y - y) * (q.x - x);
  };
  const double wa = turn(b, c), wb = turn(c, a), wc = turn(a, b), sum = wa + wb + wc;
  const bool inside = (wa >= 0 && wb >= 0 && wc >= 0) || (wa <= 0 && wb <= 0 && wc <= 0);
  if (!inside || sum == 0) return std::nullopt;
  return (wa * a.z + wb * b.z + wc * c.z) / sum;
}

glm::dvec3 position_of(const ObjectDescription& object, const LocalFrame& frame) {
  const auto [east, north, up] = object.position_m;
  if (!object.position_lat_lon_deg) return {east, north, up};
  if (!frame.is_georeferenced()) {
    throw InputError(
        object.place,
        "position_lat_lon_deg needs a [georeference], which the scene does not have: add one, or "
        "give position_m");
  }
  const auto [latitude, longitude] = *object.position_lat_lon_deg;
  // A vertical is not the local up away from a tangent frame's origin: the height that ends at `up` comes
  // second.
  const double height = up - frame.from_lat_lon(latitude, longitude, 0, object.place).z;
  const glm::dvec3 local = frame.from_lat_lon(latitude, longitude, height, object.place);
  return {local.x, local.y, up};
}

}  // namespace

std::optional<double> terrain_height_m(std::span<const ComponentMesh> terrains, double east_m,
                                       double north_m) {
  std::optional<double> highest;
  for (const ComponentMesh& terrain : terrains) {
    for (const auto& [a, b, c] : terrain.triangles) {
      const auto& p = terrain.points_m;
      const auto height = height_of(p[a], p[b], p[c], east_m, north_m);
      if (height && (!highest || *height > *highest)) highest = height;
    }
  }
  return highest;
}

void place_object(ComponentMesh& mesh, const ObjectDescription& object, const LocalFrame& frame,
                  const std::function<std::optional<double>(double, double)>& height_m,
                  const std::function<std::string()>& extent) {
  const glm::dvec3 position = position_of(object, frame);
  const glm::dquat attitude = attitude_from_angles(
      glm::radians(object.heading_deg), glm::radians(object.pitch_deg), glm::radians(object.roll_deg));
  const glm::dvec3 scale(object.scale[0], object.scale[1], object.scale[2]);
  double lowest = std::numeric_limits<double>::infinity();
  for (glm::dvec3& p : mesh.points_m) {
    p = position + attitude * (scale * p);
    lowest = std::min(lowest, p.z);
  }
  if (object.on_terrain_m) {
    const auto ground = height_m(position.x, position.y);
    if (!ground) {
      throw InputError(
          object.place,
          fmt::format("on_terrain_m: there is no terrain below the object's position ({:.3f} m "
                      "east, {:.3f} m north), and terrain covers {}: move it, or give the height "
                      "in position_m",
                      position.x, position.y, extent()));
    }
    const double shift = *ground + *object.on_terrain_m - lowest;
    for (glm::dvec3& p : mesh.points_m) p.z += shift;
  }
}

}  // namespace tubefoot
