// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <map>

#include "geometry/footprints/facet_regions.hpp"
#include "geometry/footprints/line_areas.hpp"
#include "geometry/footprints/seen_piece.hpp"
#include "geometry/footprints/shared_footprints.hpp"
#include "geometry/steps/stop.hpp"
#include "geometry/visibility/topology_hasher.hpp"

// Checks the common visibility of a facet with exact areas. For each apex, the shared parts and the parts
// that only this apex sees must add up to all that it sees (SharedAudit, Law S5).

namespace tubefoot {
namespace {

using Walls = std::vector<const PlaneLine*>;

Walls walls_of(SeenPiece& piece) {
  Walls walls;
  for (const PlaneLine& line : piece.lines())
    if (!line.is_none()) walls.push_back(&line);
  return walls;
}

bool lies_within(const LinePolygon& polygon, const Walls& walls) {
  for (std::size_t k = 0; k < polygon.size(); ++k)
    for (const PlaneLine* wall : walls)
      if (side(*polygon[k == 0 ? polygon.size() - 1 : k - 1], *polygon[k], *wall) < 0) return false;
  return true;
}

/// Subtracts the polygons with these walls from the polygons of `rest`.
void take_away(const std::vector<Walls>& others, std::vector<LinePolygon>& rest, LineStore& store) {
  for (const Walls& walls : others) {
    std::vector<LinePolygon> outside;
    for (LinePolygon& polygon : rest) {
      stop_if_wanted();
      if (!split_off(polygon, walls, store, outside)) outside.push_back(std::move(polygon));
    }
    rest = std::move(outside);
  }
}

Fraction area_of(const std::vector<LinePolygon>& polygons) {
  std::vector<Fraction> areas;
  for (const LinePolygon& polygon : polygons) areas.push_back(double_area(polygon));
  return sum(areas);
}

}  // namespace

SharedAudit FootprintSharer::audit(std::size_t number, std::uint64_t label) const {
  OnFacet on(*this, facets_[number]);
  std::vector<Walls> walls_sent, walls_received;
  for (SeenPiece& s : on.sent) walls_sent.push_back(walls_of(s));
  for (SeenPiece& h : on.received) walls_received.push_back(walls_of(h));

  SharedAudit result;
  bool inside = true;
  // The apertures of images overlap by the rounding of their corners. The code therefore checks one aperture
  // at a time.
  const bool windows = transmit_.mesh != nullptr;
  const auto of_tube = [&](SeenPiece& piece) { return windows ? piece.tube() : 0; };
  std::map<std::uint32_t, std::vector<LinePolygon>> by_sent, by_received;  // shared polygons
  std::map<std::uint32_t, std::vector<Walls>> sent_by, received_by;
  for (std::size_t s = 0; s < on.sent.size(); ++s) sent_by[of_tube(on.sent[s])].push_back(walls_sent[s]);
  for (std::size_t h = 0; h < on.received.size(); ++h)
    received_by[of_tube(on.received[h])].push_back(walls_received[h]);
  std::vector<LinePolygon> shared, all_sent, all_received;
  for (std::size_t s = 0; s < on.sent.size(); ++s) {
    if (!on.sent[s].polygon().empty()) all_sent.push_back(on.sent[s].polygon());
    for (std::size_t h = 0; h < on.received.size(); ++h) {
      stop_if_wanted();
      if (!images_ && !on.sent[s].may_meet(on.received[h])) continue;
      LinePolygon polygon;
      shared_by(on.sent[s], on.received[h], polygon);
      if (polygon.empty()) continue;
      inside = inside && lies_within(polygon, walls_sent[s]) && lies_within(polygon, walls_received[h]);
      by_sent[of_tube(on.sent[s])].push_back(polygon);
      by_received[of_tube(on.received[h])].push_back(polygon);
      shared.push_back(std::move(polygon));
    }
  }
  for (SeenPiece& h : on.received)
    if (!h.polygon().empty()) all_received.push_back(h.polygon());

  const auto u = [&](std::size_t k) {
    const std::array<std::int64_t, 3> p{on.from_transmitter.point[k].x, on.from_transmitter.point[k].y,
                                        on.from_transmitter.point[k].z},
        q{on.from_transmitter.point[0].x, on.from_transmitter.point[0].y, on.from_transmitter.point[0].z};
    return std::array{Integer(p[std::size_t(on.chart.u)] - q[std::size_t(on.chart.u)]),
                      Integer(p[std::size_t(on.chart.v)] - q[std::size_t(on.chart.v)])};
  };
  const Integer whole = u(1)[0] * u(2)[1] - u(1)[1] * u(2)[0];
  bool adds_up = true;
  const auto check = [&](std::vector<LinePolygon> polygons, const std::vector<Walls>& others,
                         const std::vector<LinePolygon>& in_both) {
    const Fraction own = area_of(polygons), common = area_of(in_both);
    LineStore store;
    take_away(others, polygons, store);
    const Fraction left = sum({common, area_of(polygons)});
    if (equal(left, own)) return;
    adds_up = false;
    result.defect += std::abs(share_of(sum({left, {Integer(-own.numerator), own.denominator}}), whole).share);
  };
  for (const auto& [tube, walls] : received_by) check(all_sent, walls, by_received[tube]);
  for (const auto& [tube, walls] : sent_by) check(all_received, walls, by_sent[tube]);
  result.closes = inside && adds_up;
  result.pieces = shared.size();
  if (!shared.empty()) {
    const Fraction common = area_of(shared);
    TopologyHasher hasher;
    hasher.add(label);
    hasher.add(mesh_, on.from_transmitter.id, transmit_.tubes.apex);
    hasher.add(images_ ? *receive_.mesh : mesh_, on.from_receiver.id, receive_.tubes.apex);
    const Fraction share = reduced({common.numerator, product(common.denominator, whole)});
    hasher.add(Integer(abs(share.numerator)));
    hasher.add(share.denominator);
    result.hash = hasher.get();
  }
  return result;
}

}  // namespace tubefoot
