// SPDX-License-Identifier: GPL-3.0-or-later
// Writes eigenrays and fans of rays as CSV.
#include <fmt/format.h>

#include <cmath>
#include <iterator>

#include "geometry/numbers/scalars.hpp"
#include "propagation/ray_path.hpp"
#include "propagation/rays_output.hpp"

namespace tubefoot {
namespace {

const char* name_of(const RayNode* node) {
  if (node == nullptr) return "arc";
  switch (node->event) {
    case RayEvent::launch:
      return "launch";
    case RayEvent::layer:
      return "layer";
    case RayEvent::surface:
      return "surface";
    case RayEvent::bottom:
      return "bottom";
    default:
      return "end";
  }
}

std::string joined(const std::vector<double>& depths_m) {
  std::string text;
  for (const double depth_m : depths_m)
    fmt::format_to(std::back_inserter(text), "{}{:.9g}", text.empty() ? "" : ";", depth_m);
  return text;
}

}  // namespace

std::string to_csv(const RaysRequest& request, const std::vector<PointArrivals>& points) {
  std::string text =
      "point,x_m,y_m,z_m,range_m,depth_m,bearing_deg,eigenrays,eigenray,launch_down_deg,arrival_down_deg,"
      "time_s,length_m,spreading_loss_db,absorption_db,transmission_loss_db,tube_area_m2_per_sr,crossed,"
      "surface_reflections,bottom_reflections,turns,turning_depths_m\n";
  const double source_speed = request.water.profile.at(request.depth_m(request.source_m));
  for (std::size_t k = 0; k < points.size(); ++k) {
    const PointArrivals& point = points[k];
    const glm::dvec3 along_m = point.point_m - request.source_m;
    const double bearing_rad = point.range_m > 0 ? std::atan2(along_m.x, along_m.y) : 0;
    const std::string place =
        fmt::format("{},{:.12g},{:.12g},{:.12g},{:.12g},{:.12g},{:.12g},{}", k + 1, point.point_m.x,
                    point.point_m.y, point.point_m.z, point.range_m, point.depth_m,
                    bearing_rad / degree + (bearing_rad < 0 ? 360 : 0), point.arrivals.size());
    if (point.arrivals.empty()) text += place + ",,,,,,,,,,,,,,\n";
    const double speed = request.water.profile.at(point.depth_m);
    for (std::size_t i = 0; i < point.arrivals.size(); ++i) {
      const RayArrival& ray = point.arrivals[i];
      const double loss_db = spreading_loss_db(ray.tube_area_m2_per_sr, source_speed, speed);
      fmt::format_to(std::back_inserter(text),
                     "{},{},{:.15g},{:.15g},{:.15g},{:.12g},{:.6f},{:.6f},{:.6f},{:.9g},{},{},{},{},{}\n",
                     place, i + 1, ray.launch_rad / degree, ray.arrival_rad / degree, ray.time_s,
                     ray.length_m, loss_db, ray.absorption_db, loss_db + ray.absorption_db,
                     ray.tube_area_m2_per_sr, ray.crossed ? 1 : 0, ray.surface_reflections,
                     ray.bottom_reflections, ray.turning_depths_m.size(), joined(ray.turning_depths_m));
    }
  }
  return text;
}

std::string to_csv(const RaysRequest& request, const std::vector<FanRay>& fan) {
  std::string text =
      "ray,launch_down_deg,event,range_m,depth_m,angle_down_deg,time_s,length_m,spreading_loss_db,"
      "absorption_db,turned_at_m\n";
  const double source_speed = request.water.profile.at(request.depth_m(request.source_m));
  for (std::size_t k = 0; k < fan.size(); ++k)
    for (const PathPoint& point : points_along(fan[k].nodes, degree)) {
      const bool has_tube = point.node != nullptr && point.node->event != RayEvent::launch;
      fmt::format_to(
          std::back_inserter(text), "{},{:.12g},{},{:.12g},{:.12g},{:.12g},{:.15g},{:.12g},{},{:.6f},{}\n",
          k + 1, fan[k].launch_rad / degree, name_of(point.node), point.range_m, point.depth_m,
          point.angle_rad / degree, point.time_s, point.length_m,
          has_tube
              ? fmt::format("{:.6f}", spreading_loss_db(point.node->state.tube_area_m2_per_sr, source_speed,
                                                        request.water.profile.at(point.depth_m)))
              : std::string(),
          point.absorption_db,
          point.node != nullptr && point.node->turned_at_m ? fmt::format("{:.9g}", *point.node->turned_at_m)
                                                           : std::string());
    }
  return text;
}

}  // namespace tubefoot
