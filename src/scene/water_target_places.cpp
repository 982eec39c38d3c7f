// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/water_target_places.hpp"

#include "scene/scene_placement.hpp"

namespace tubefoot {

double sea_surface_height_m(const SceneDescription& description) {
  return description.sea_surface ? description.sea_surface->height_m
                                 : description.water.surface_height_m.value_or(0);
}

bool has_sea_surface(const SceneDescription& description) {
  return description.sea_surface.has_value() || description.water.surface_height_m.has_value();
}

glm::dvec3 position_of(const WaterTargetDescription& target, const LocalFrame& frame) {
  const auto [east, north, up] = target.position_m;
  if (!target.position_lat_lon_deg) return {east, north, up};
  const auto [latitude, longitude] = *target.position_lat_lon_deg;
  glm::dvec3 point(longitude, latitude, up);
  place_by_lon_lat(
      {&point, 1}, frame, target.place,
      "position_lat_lon_deg needs a [georeference], which the scene does not have: add one, or give "
      "position_m");
  return point;
}

Extent extent_of(const TargetPopulationDescription& population, double sea_surface_height_m) {
  const auto [east, north] = population.centre_m;
  const auto [width, length] = population.size_m;
  Extent extent;
  extent.add(
      {east - width / 2, north - length / 2, sea_surface_height_m - population.bottom_depth_m.value_or(0)});
  extent.add(
      {east + width / 2, north + length / 2, sea_surface_height_m - population.top_depth_m.value_or(0)});
  return extent;
}

std::vector<TargetExtent> water_target_extents(const SceneDescription& description, const LocalFrame& frame) {
  std::vector<TargetExtent> extents;
  for (const WaterTargetDescription& target : description.targets) {
    extents.push_back({target.name, target.place, {}});
    extents.back().extent.add(position_of(target, frame));
  }
  for (const TargetPopulationDescription& population : description.target_populations)
    extents.push_back(
        {population.name, population.place, extent_of(population, sea_surface_height_m(description))});
  return extents;
}

}  // namespace tubefoot
