// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/signal/polygon_velocity.hpp"

#include <algorithm>
#include <glm/geometric.hpp>

// Converts velocities in the local frame to those on the plane of a polygon. See docs/notes/gradients.md,
// "Signals of smooth surfaces".

namespace tubefoot {

PlacedReceiver beside_border(const PlanarPolygon& polygon, const PathCutter::Receiver& rx, double k) {
  constexpr double least_rad = 1e-4;
  const double share = polygon.distance / (polygon.distance + rx.distance);
  const glm::dvec2 shortest = rx.foot * share;
  PlacedReceiver placed{rx, 1};
  const std::size_t n = polygon.offsets.size();
  for (std::size_t corner = 0; corner < n; ++corner) {
    const glm::dvec2 from = polygon.corner(corner) - shortest,
                     edge = polygon.corner(corner + 1 == n ? 0 : corner + 1) - shortest - from;
    const double square = glm::dot(edge, edge),
                 along = square > 0 ? std::clamp(-glm::dot(from, edge) / square, 0.0, 1.0) : 0.0;
    placed.border_rad = std::min(placed.border_rad, k * glm::length(from + along * edge));
  }
  const glm::dvec2 inward = polygon.first + centroid_offset(polygon) - shortest;
  if (placed.border_rad < least_rad && glm::length(inward) > 0) {
    placed.rx.foot += glm::normalize(inward) * (least_rad / (k * share));
    placed.border_rad = least_rad;
  }
  return placed;
}

EdgeMotion::Velocity velocity_on_plane(const SignalParameter& parameter, std::size_t patch,
                                       std::size_t channel, const PlanarPolygon& polygon,
                                       const PathCutter::Receiver& rx, const PlaneFrame& frame,
                                       glm::dvec3 normal, glm::dvec3 transmit, glm::dvec3 receive) {
  const SignalParameter::Polygon at_rest,
      &moved = parameter.polygons.empty() ? at_rest : parameter.polygons[patch];
  const auto end = [channel](const std::vector<glm::dvec3>& ends) {
    return ends.empty() ? glm::dvec3(0) : ends[channel];
  };
  const glm::dvec3 by_transmit = end(parameter.transmit), by_receive = end(parameter.receive);
  const auto in_plane = [&](glm::dvec3 v) { return glm::dvec2(glm::dot(v, frame.u), glm::dot(v, frame.v)); };
  const auto distance_of = [&](glm::dvec3 place, glm::dvec3 by_place) {
    return moved.distance + glm::dot(moved.normal, place) + glm::dot(normal, by_place);
  };
  // The frame turns with the plane, so that a vector with the component -d along the normal turns by d dn.
  const glm::dvec2 tilt = in_plane(moved.normal);
  EdgeMotion::Velocity velocity{{},
                                distance_of(transmit, by_transmit),
                                distance_of(receive, by_receive),
                                in_plane(by_receive - by_transmit) + (polygon.distance - rx.distance) * tilt};
  for (std::size_t k = 0; k < polygon.offsets.size(); ++k)
    velocity.corners.push_back(
        in_plane((moved.corners.empty() ? glm::dvec3(0) : moved.corners[k]) - by_transmit) +
        polygon.distance * tilt);
  return velocity;
}

}  // namespace tubefoot
