// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "geometry/integrals/edge_panels.hpp"

namespace tubefoot {

/// Derivatives of the integral of EdgePanels by the positions of its polygon and apexes, for fixed panels.
class EdgeMotion {
 public:
  /// Velocities of a polygon and of both apexes. Coordinates refer to a frame that moves with the plane, and
  /// to the foot point of the transmit apex.
  struct Velocity {
    std::vector<glm::dvec2> corners;
    double distance = 0;     ///< of the transmit apex from the plane
    double rx_distance = 0;  ///< of the receive apex from the plane
    glm::dvec2 rx_foot{0};
  };
  /// Derivatives of the path and of the weight of a node.
  struct NodeRate {
    double path_m = 0, weight = 0;
  };

  /// Both arguments must outlive this object.
  EdgeMotion(const PlanarPolygon& polygon, const PathCutter::Receiver& rx);

  /// Returns the derivatives of a node, which keeps its share of the edge. `corner`: EdgePanels::corner_of().
  NodeRate of_node(std::size_t corner, const EdgePanels::Node& node, const Velocity& velocity) const;
  /// Returns the derivative of the shortest path.
  double of_shortest_m(const Velocity& velocity) const;

 private:
  const PlanarPolygon& polygon_;
  const PathCutter::Receiver& rx_;
  double heights_, shortest_m_;
  glm::dvec2 nearest_;  // point of shortest path
};

}  // namespace tubefoot
