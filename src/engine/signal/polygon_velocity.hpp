// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>

#include "engine/signal/smooth_signals.hpp"
#include "geometry/integrals/edge_motion.hpp"

namespace tubefoot {

/// Returns the receiver. If the point of shortest path lies on the border of the polygon, the result is a
/// neighbour of the receiver. Its point of shortest path lies inside by a phase of 1e-5 rad. On the border,
/// the derivatives of the edge and of the image are large numbers of opposite sign. `k`: wavenumber in rad/m.
PathCutter::Receiver beside_border(const PlanarPolygon& polygon, PathCutter::Receiver rx, double k);

/// Velocities of a polygon's corners and plane and of a channel's ends, in the frame of the plane.
EdgeMotion::Velocity velocity_on_plane(const SignalParameter& parameter, std::size_t patch,
                                       std::size_t channel, const PlanarPolygon& polygon,
                                       const PathCutter::Receiver& rx, const PlaneFrame& frame,
                                       glm::dvec3 normal, glm::dvec3 transmit, glm::dvec3 receive);

}  // namespace tubefoot
