// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/certified/flattened_facet.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/numbers/enclosure_slack.hpp"

namespace tubefoot {
namespace {

constexpr double slack = enclosure_slack;

}  // namespace

CertifiedPolygon flattened(std::span<const glm::dvec3> corners_m, glm::dvec3 receiver_m,
                           const BistaticFacet& bistatic) {
  constexpr double units = 0x1p-49;  // rounding of corners (FootprintSharer)
  CertifiedPolygon plane;
  plane.distance = Ball(bistatic.transmit_distance_m);
  plane.u = {Ball(1), Ball(0), Ball(0)};
  plane.v = {Ball(0), Ball(1), Ball(0)};
  plane.away = {Ball(0), Ball(0), Ball(1)};
  std::vector<CertifiedPolygon::Point> points;
  for (const glm::dvec3& corner : corners_m) {
    std::array<Ball, 3> two_way;
    for (int k = 0; k < 3; ++k) {
      Ball& own = two_way[std::size_t(k)] = Ball(corner[k]);
      own.add_error(Ball(
          units * (std::abs(corner[k]) + std::abs(corner[k] - receiver_m[k]) + std::abs(receiver_m[k]))));
      own = own - Ball(bistatic.to_plane.seen_m[k]);
    }
    const auto along = [&](int row) {
      Ball sum(bistatic.to_plane.lies_m[row]);
      for (int k = 0; k < 3; ++k) sum += Ball(bistatic.to_plane.linear[k][row]) * two_way[std::size_t(k)];
      return sum;
    };
    points.push_back({along(0), along(1)});
  }
  return part_of(plane, std::move(points));
}

CertifiedPathEnergy energy_of(const BistaticFacet& bistatic, const BistaticEnclosure& proven,
                              const EchoModel& model, std::uint16_t material, const Ball& beta_per_m) {
  const ApexOverPlane tx{Ball(bistatic.transmit_distance_m), Ball(0), Ball(0)},
      rx{Ball(bistatic.receive_distance_m), Ball(bistatic.receive_foot_m.x), Ball(bistatic.receive_foot_m.y)};
  const auto model_of = [&](std::size_t e) { return proven.model[e] ? &*proven.model[e] : nullptr; };
  return {{tx, bistatic.transmit_seen}, {rx, bistatic.receive_seen}, model.path,
          {model_of(0), model_of(1)},   model.material_mu[material], beta_per_m};
}

Towards seen_rx(const CertifiedPolygon& polygon, const BistaticFacet& bistatic) {
  std::vector<glm::dvec3> seen;
  for (const CertifiedPolygon::Point& p : polygon.points)
    seen.push_back(bistatic.receive_seen.at({p.x.middle(), p.y.middle()}));
  return Towards::places(seen);
}

FacetMap map_of(const LyingPlane& lies) {
  return {glm::dvec3(0), lies.foot_m, glm::dmat3(lies.u, lies.v, glm::dvec3(0))};
}

double change_of(const CertifiedTexture& texture, double way_m) {
  if (!(way_m > 0)) return 0;
  double per_m = 0;
  for (const CertifiedTexture::Axis& axis : texture.axes())
    per_m =
        std::max(per_m, root(squared(axis.per_m[0]) + squared(axis.per_m[1]) + squared(axis.per_m[2])).hi());
  return std::min(texture.change(per_m * way_m * (1 + slack)), texture.range().hi());
}

}  // namespace tubefoot
