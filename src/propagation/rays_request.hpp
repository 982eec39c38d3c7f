// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "propagation/arrivals.hpp"

// Arguments of the command `rays`, and its computation.
namespace tubefoot {

/// The water, the source and the limits of the rays. Positions are in the local frame, where z points up.
struct RaysRequest {
  WaterColumn water;
  std::string water_name;       ///< for titles
  double surface_height_m = 0;  ///< height of depth 0
  glm::dvec3 source_m{0};
  ArrivalOptions options;  ///< depths of surface and bottom

  double depth_m(const glm::dvec3& point_m) const { return surface_height_m - point_m.z; }
};

/// Parses "X,Y,Z" in m. Throws UsageError, which names the option.
glm::dvec3 point_of(const std::string& text, const std::string& option);

/// Returns the points of a CSV file with the columns x_m, y_m and z_m. Throws InputError.
std::vector<glm::dvec3> points_of_file(const std::filesystem::path& file);

/// Parses ranges or depths in m or, with the suffix km, in km, as numbers_of() does.
std::vector<double> lengths_of(const std::string& text, const std::string& option);

/// Returns the points at all pairs of a horizontal range and a depth, by depth. They lie east of the source.
std::vector<glm::dvec3> points_at(const RaysRequest& request, const std::vector<double>& ranges_m,
                                  const std::vector<double>& depths_m);

/// Eigenrays of one point.
struct PointArrivals {
  glm::dvec3 point_m{0};
  double range_m = 0, depth_m = 0;  ///< horizontal, from the source
  std::vector<RayArrival> arrivals;
};

/// Computes the eigenrays of all points, in parallel. Throws UsageError for a point outside of the water or
/// at the source.
std::vector<PointArrivals> eigenrays_of(const RaysRequest& request, const std::vector<glm::dvec3>& points_m,
                                        bool quiet);

/// A traced ray of a fan.
struct FanRay {
  double launch_rad = 0;
  std::vector<RayNode> nodes;
};

/// Traces rays of these launch angles to a horizontal range, or to the last reflection that the request
/// permits. `most_reflections`: none for any number. Throws UsageError for a vertical ray.
std::vector<FanRay> fan_of(const RaysRequest& request, const std::vector<double>& angles_deg, double range_m,
                           std::optional<int> most_reflections);

}  // namespace tubefoot
