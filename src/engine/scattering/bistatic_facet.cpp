// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/scattering/bistatic_facet.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace tubefoot {

// The distance of the middle from the plane's point p is sqrt(D^2 + |p - F|^2). Its apparent position s(p)
// is linear in p. The distance of the end is the root of D^2 + |p - F|^2 - 2 by . s(p) + by^2. This is again
// a distance and a foot point.
bool BistaticFacet::move_receiver(glm::dvec3 by_m) {
  const LyingPlane& seen = receive_seen;
  const glm::dvec2 from = receive_foot_m,
                   foot = from + glm::dvec2(glm::dot(by_m, seen.u), glm::dot(by_m, seen.v));
  const double distance2 = receive_distance_m * receive_distance_m + glm::dot(from, from) -
                           glm::dot(foot, foot) + glm::dot(by_m, by_m) - 2 * glm::dot(by_m, seen.foot_m);
  if (!(distance2 > 0)) return false;
  receive_distance_m = std::sqrt(distance2);
  receive_foot_m = foot;
  receive_seen.foot_m -= by_m;
  return true;
}

double bistatic_factor(const BistaticFacet& facet, const ScatteringModel* model) {
  const auto sigma = [model](double sine) {
    if (model == nullptr) return sine * sine;
    sine = std::min(sine, 1.0);
    return model->cross_section(sine, std::sqrt((1 - sine) * (1 + sine)));
  };
  double sum = 0;
  for (const BistaticFacet::Corner& c : facet.corners) {
    const double seen = sigma(c.transmit_seen) * sigma(c.receive_seen);
    if (seen > 0 && std::isfinite(c.gain))
      sum += c.gain * std::sqrt(sigma(c.transmit_lies) * sigma(c.receive_lies) / seen);
  }
  return sum / 3;
}

}  // namespace tubefoot
