// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>

#include "engine/signal/smooth_signals.hpp"
#include "geometry/integrals/edge_motion.hpp"

namespace tubefoot {

/// A receiver whose point of shortest path does not lie on the border of a polygon.
struct PlacedReceiver {
  PathCutter::Receiver rx;
  double border_rad;  ///< phase between the border and the point of shortest path, at most 1
};
/// Returns the receiver. If its point of shortest path lies on the border of the polygon, the result is a
/// neighbour of the receiver. Its point of shortest path lies inside by a phase of 1e-4 rad. Near the border,
/// the derivatives of the edge and of the image are large numbers of opposite sign. `k`: wavenumber in rad/m.
PlacedReceiver beside_border(const PlanarPolygon& polygon, const PathCutter::Receiver& rx, double k);

/// Velocities of a polygon's corners and plane and of a channel's ends, in the frame of the plane.
EdgeMotion::Velocity velocity_on_plane(const SignalParameter& parameter, std::size_t patch,
                                       std::size_t channel, const PlanarPolygon& polygon,
                                       const PathCutter::Receiver& rx, const PlaneFrame& frame,
                                       glm::dvec3 normal, glm::dvec3 transmit, glm::dvec3 receive);

}  // namespace tubefoot
