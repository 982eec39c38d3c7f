// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/rasters/earth_place.hpp"

#include <fmt/format.h>

#include <GeographicLib/Geodesic.hpp>
#include <GeographicLib/LocalCartesian.hpp>
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "files/gdal_input.hpp"

namespace tubefoot {

glm::dvec3 EarthPlace::direction(glm::dvec3 local) const {
  const glm::dvec3 turned = to_east_north_up * local;
  const double level = std::hypot(turned.x, turned.y),
               wanted = std::sqrt(std::max(0.0, 1 - turned.z * turned.z));
  const double stretch = level > 0 ? wanted / level : 1;
  return {turned.x * stretch, turned.y * stretch, turned.z};
}

std::vector<EarthPlace> on_earth(const LocalFrame& frame, std::span<const glm::dvec3> points,
                                 const SourcePlace& place) {
  // Central differences. The map's curvature causes an error of (step / R)^2 = 2e-10 of a direction, the
  // digits of degrees in a double one of 1e-11.
  constexpr double step_m = 100;
  constexpr glm::dvec3 around[] = {
      {0, 0, 0}, {step_m, 0, 0}, {-step_m, 0, 0}, {0, step_m, 0}, {0, -step_m, 0}};
  std::vector<glm::dvec3> all;
  all.reserve(points.size() * std::size(around));
  for (const glm::dvec3 point : points)
    for (const glm::dvec3 step : around) all.push_back(point + step);
  frame.to_lon_lat(all, place);

  std::vector<EarthPlace> places;
  places.reserve(points.size());
  for (auto at = all.begin(); at != all.end(); at += std::size(around)) {
    // A tangent frame is rigid everywhere. A map has no heights.
    const auto height_m = [&](glm::dvec3 p) { return frame.is_tangent() ? p.z : 0; };
    const GeographicLib::LocalCartesian here(at->y, at->x, height_m(*at));
    const auto seen_from_here = [&](glm::dvec3 p) {
      glm::dvec3 q;
      here.Forward(p.y, p.x, height_m(p), q.x, q.y, q.z);
      return q;
    };
    const auto axis = [&](int k) {
      return (seen_from_here(at[2 * k + 1]) - seen_from_here(at[2 * k + 2])) / (2 * step_m);
    };
    glm::dvec3 east = axis(0), north = axis(1), up(0, 0, 1);
    if (frame.is_tangent())
      up = glm::normalize(glm::cross(east, north));
    else
      east.z = north.z = 0;
    places.push_back({*at, glm::dmat3(east, north, up)});
  }
  return places;
}

std::optional<std::string> scale_warning(const LocalFrame& frame) {
  if (!frame.is_georeferenced() || frame.is_tangent()) return std::nullopt;
  EarthPlace origin;
  try {
    const glm::dvec3 zero(0);
    origin = on_earth(frame, {&zero, 1}, {}).front();
  } catch (const InputError&) {
    return std::nullopt;  // other functions report the error when they need a place there
  }
  constexpr double tolerated = 0.01;
  const double east = 1 / glm::length(origin.to_east_north_up[0]),
               north = 1 / glm::length(origin.to_east_north_up[1]);
  if (std::abs(east - 1) <= tolerated && std::abs(north - 1) <= tolerated) return std::nullopt;
  return fmt::format(
      "the map of the scene is not true to scale: at its origin ({:.4f} N, {:.4f} E) a metre to the east is "
      "{:.4g} m on the map, and a metre to the north is {:.4g} m. tubefoot computes ranges, areas and "
      "energies from distances on the map: transform the data to a local map first, such as that of the UTM "
      "zone, with `gdalwarp -t_srs EPSG:... {} IN OUT`",
      origin.lon_lat_height.y, origin.lon_lat_height.x, east, north, warp_heights);
}

glm::dvec3 east_north_up_between(glm::dvec3 from, glm::dvec3 to) {
  double distance_m = 0, azimuth_deg = 0, end_azimuth_deg = 0;
  GeographicLib::Geodesic::WGS84().Inverse(from.y, from.x, to.y, to.x, distance_m, azimuth_deg,
                                           end_azimuth_deg);
  const double azimuth_rad = azimuth_deg * std::numbers::pi / 180;
  return {distance_m * std::sin(azimuth_rad), distance_m * std::cos(azimuth_rad), to.z - from.z};
}

}  // namespace tubefoot
