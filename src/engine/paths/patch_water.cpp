// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/paths/patch_water.hpp"

#include <algorithm>
#include <glm/geometric.hpp>

#include "engine/water/apparent_map.hpp"

namespace tubefoot {

WaterColumn continued_below(const WaterColumn& water, double depth_m, double further_m) {
  constexpr double same_depth_m = 1e-6;
  const std::vector<ProfilePoint>& points = water.profile.points();
  const auto end =
      std::ranges::find_if(points, [&](const ProfilePoint& p) { return p.depth_m > depth_m - same_depth_m; });
  const auto layer = static_cast<std::size_t>(end - points.begin());
  const double gradient = water.profile.gradient_per_s(layer), speed = water.profile.at(depth_m);
  if (gradient == 0) return water;  // straight rays in this layer
  // The sound speed stays above half of its value at the seabed.
  const double by_m = gradient < 0 ? std::min(further_m, speed / (-2 * gradient)) : further_m;
  WaterColumn column;
  std::vector<ProfilePoint> above(points.begin(), end);
  above.push_back({depth_m, speed});
  above.push_back({depth_m + by_m, speed + gradient * by_m});
  column.profile = SoundSpeedProfile(above);
  for (std::size_t k = 0; k <= above.size() && !water.absorption_db_per_m.empty(); ++k)
    column.absorption_db_per_m.push_back(water.absorption_in(std::min(k, layer)));
  return column;
}

void SurfaceCounts::add(const SurfaceCounts& more) {
  facets += more.facets;
  in_shadow += more.in_shadow;
  of_several += more.of_several;
  folded += more.folded;
  largest_travel_path_error_m = std::max(largest_travel_path_error_m, more.largest_travel_path_error_m);
  for (const UnclearPlace& place : more.unclear)
    if (std::ranges::none_of(unclear, [&](const UnclearPlace& known) {
          return (known.eigenrays == 0) == (place.eigenrays == 0);
        }))
      unclear.push_back(place);
}

SurfaceCounts counts_from(const ApparentSurface& surface_mesh, const ApparentMap& water, glm::dvec3 front,
                          double before_m) {
  SurfaceCounts counts;
  counts.facets = surface_mesh.refined.mesh.facets.size();
  counts.of_several = surface_mesh.facets_of_several;
  counts.largest_travel_path_error_m = surface_mesh.largest_travel_path_error_m;
  const glm::dvec3 apex_m = water.apex_m();
  for (const auto& corners : surface_mesh.left_out_m) {
    const bool lies_before =
        front == glm::dvec3(0) || std::ranges::any_of(corners, [&](const glm::dvec3& corner) {
          return glm::dot(front, corner - apex_m) > before_m;
        });
    counts.in_shadow += lies_before;
    if (!lies_before || !counts.unclear.empty()) continue;
    const glm::dvec3 centre = (corners[0] + corners[1] + corners[2]) / 3.0;
    counts.unclear.push_back({0, centre, 0, glm::normalize(centre - apex_m)});
  }
  const auto several =
      std::ranges::find_if(surface_mesh.unclear, [](const UnclearPlace& p) { return p.eigenrays > 1; });
  if (several != surface_mesh.unclear.end()) counts.unclear.push_back(*several);
  return counts;
}

std::size_t folded_facets(const VisibleSurface& seabed) {
  constexpr double least_sine = 0.01;
  return static_cast<std::size_t>(std::ranges::count_if(seabed.shared.facets, [&](const SharedFacet& facet) {
    const RefractedFacet& refracted = *seabed.refracted_of(facet);
    const glm::dvec3 at = seabed.shared.corners_m[seabed.shared.pieces[facet.first_piece].first];
    return glm::dot(refracted.normal, facet.plane_normal) < 0 &&
           facet.transmit_distance_m > least_sine * glm::length(at) &&
           refracted.sine(at, refracted.ray_to(refracted.lies.at(at))) > least_sine;
  }));
}

}  // namespace tubefoot
