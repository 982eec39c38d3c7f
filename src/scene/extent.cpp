// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/extent.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

#include "scene/scene.hpp"

namespace tubefoot {
namespace {

bool looks_like_utm(glm::dvec3 place_m) {
  return place_m.x > 1e5 && place_m.x < 9e5 && std::abs(place_m.y) > 1e5 && std::abs(place_m.y) < 1e7;
}

}  // namespace

void Extent::add(glm::dvec3 point_m) {
  lo_m = glm::min(lo_m, point_m);
  hi_m = glm::max(hi_m, point_m);
}

double Extent::distance_in_plan_m(glm::dvec3 place_m) const {
  const glm::dvec3 gap = glm::max(glm::max(lo_m - place_m, place_m - hi_m), glm::dvec3(0));
  return std::hypot(gap.x, gap.y);
}

std::string to_text(const Extent& extent) {
  return fmt::format("east {:.8g} to {:.8g}, north {:.8g} to {:.8g}, up {:.6g} to {:.6g} m", extent.lo_m.x,
                     extent.hi_m.x, extent.lo_m.y, extent.hi_m.y, extent.lo_m.z, extent.hi_m.z);
}

std::string mixed_frames(glm::dvec3 place_m, const Extent& terrain) {
  constexpr double another_frame_m = 1e5;
  if (terrain.distance_in_plan_m(place_m) < another_frame_m) return {};
  if (looks_like_utm(place_m))
    return "its coordinates look like UTM easting and northing, but must be relative to the frame's origin: "
           "subtract origin_crs of [georeference]";
  if (looks_like_utm((terrain.lo_m + terrain.hi_m) / 2.0))
    return "the terrain's coordinates look like UTM easting and northing: set crs and origin_crs in "
           "[georeference], with an origin on the terrain";
  return "give both in the same frame";
}

Extent extent_of(const Scene& scene, Components which) {
  Extent extent;
  const std::size_t terrains = scene.description.terrains.size();
  for (std::size_t i = 0; i < scene.report.components.size(); ++i) {
    const ComponentReport& component = scene.report.components[i];
    if (component.facets == 0 || (which == Components::terrains && i >= terrains)) continue;
    extent.add(component.lo_m);
    extent.add(component.hi_m);
  }
  return extent;
}

}  // namespace tubefoot
