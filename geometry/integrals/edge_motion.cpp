// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/integrals/edge_motion.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "geometry/numbers/scalars.hpp"

// Differentiates the integrand of edge_form.hpp, w dpsi, at a fixed share of a moving edge. All factors of
// the weight are products, so their logarithmic derivatives add up. Source: docs/notes/gradients.md, "Signals
// of smooth surfaces".

namespace tubefoot {

EdgeMotion::EdgeMotion(const PlanarPolygon& polygon, const PathCutter::Receiver& rx)
    : polygon_(polygon),
      rx_(rx),
      heights_(polygon.distance + rx.distance),
      shortest_m_(std::sqrt(heights_ * heights_ + glm::dot(rx.foot, rx.foot))),
      nearest_(rx.foot * (polygon.distance / heights_)) {}

double EdgeMotion::of_shortest_m(const Velocity& velocity) const {
  return (heights_ * (velocity.distance + velocity.rx_distance) + glm::dot(rx_.foot, velocity.rx_foot)) /
         shortest_m_;
}

EdgeMotion::NodeRate EdgeMotion::of_node(std::size_t corner, const EdgePanels::Node& node,
                                         const Velocity& velocity) const {
  const std::size_t next = corner + 1 == polygon_.offsets.size() ? 0 : corner + 1;
  const glm::dvec2 edge = polygon_.offsets[next] - polygon_.offsets[corner],
                   start = polygon_.first - nearest_ + polygon_.offsets[corner];
  const double length = glm::length(edge), from = glm::dot(start, edge) / length,
               share = std::clamp((node.at - from) / length, 0.0, 1.0);
  const glm::dvec2 from_nearest = start + share * edge, from_tx = from_nearest + nearest_,
                   from_rx = from_tx - rx_.foot;
  const glm::dvec2 &first = velocity.corners[corner], &second = velocity.corners[next],
                   moved = first + share * (second - first);

  const double tx_m = std::hypot(polygon_.distance, from_tx.x, from_tx.y),
               rx_m = std::hypot(rx_.distance, from_rx.x, from_rx.y),
               by_tx = (polygon_.distance * velocity.distance + glm::dot(from_tx, moved)) / tx_m,
               by_rx =
                   (rx_.distance * velocity.rx_distance + glm::dot(from_rx, moved - velocity.rx_foot)) / rx_m;

  const double by_heights = velocity.distance + velocity.rx_distance, by_shortest = of_shortest_m(velocity);
  const double difference = tx_m - rx_m, across = (shortest_m_ - difference) * (shortest_m_ + difference),
               by_across = 2 * (shortest_m_ * by_shortest - difference * (by_tx - by_rx));

  const glm::dvec2 by_nearest =
      (velocity.rx_foot * polygon_.distance +
       rx_.foot *
           ((velocity.distance * rx_.distance - polygon_.distance * velocity.rx_distance) / heights_)) /
      heights_;
  const glm::dvec2 by_from_nearest = moved - by_nearest;
  const double area = cross(start, edge),
               by_area = cross(by_from_nearest, edge) + cross(from_nearest, second - first);

  const double tilted = glm::dot(from_nearest, rx_.foot) / shortest_m_,
               by_tilted = (glm::dot(by_from_nearest, rx_.foot) + glm::dot(from_nearest, velocity.rx_foot) -
                            tilted * by_shortest) /
                           shortest_m_,
               square = glm::dot(from_nearest, from_nearest) - tilted * tilted,
               by_square = 2 * (glm::dot(from_nearest, by_from_nearest) - tilted * by_tilted);

  return {by_tx + by_rx,
          node.weight * (by_heights / heights_ - 2 * by_shortest / shortest_m_ + by_across / across -
                         by_tx / tx_m - by_rx / rx_m + by_area / area - by_square / square)};
}

}  // namespace tubefoot
