// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "geometry/integrals/polar_polygon.hpp"
#include "geometry/integrals/polar_slabs.hpp"

// The arcs in which circles of constant slant range meet a convex polygon, as functions of range, for any
// number type. See docs/notes/certified-energies.md.
namespace tubefoot {

/// Calls pair(begin, end) for each crossing at which the polygon begins and the next one at which it ends.
/// `sorted`: angles about the foot point in increasing order, with their crossings. As many crossings begin
/// as end. Stops and returns false if `pair` returns false.
template <class Angle, class Pair>
bool pair_crossings(std::span<const std::pair<Angle, Crossing>> sorted, const Pair& pair) {
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    if (!sorted[i].second.rising) continue;
    std::size_t k = (i + 1) % sorted.size();
    while (sorted[k].second.rising) k = (k + 1) % sorted.size();
    if (!pair(sorted[i].second, sorted[k].second)) return false;
  }
  return true;
}

/// The arcs of one slab of a polygon (polar_slabs.hpp). Let q be the largest range of the nearest point of an
/// edge that the slab's circles meet. With r^2 = q^2 + t^2 the ends of the arcs are analytic functions of t.
/// `Numbers`: see polar_numbers.hpp. Functions of N take Numbers::Number, or a complex type about it.
template <class Numbers>
class PolarArcs {
 public:
  using Fine = typename Numbers::Fine;
  using Number = typename Numbers::Number;
  using Polygon = PolarPolygon<Fine, Number>;

  void take_polygon(const Polygon& polygon) {
    polygon_ = &polygon;
    distance_ = Numbers::number(polygon.distance);
    distance2_ = squared(polygon.distance);
  }
  /// Chooses q and pairs the arcs. Returns false if the pairs are not certain.
  bool prepare(std::span<const Crossing> crossings, const PolarSlabs::Slab& slab);

  Number t_at(const Fine& range) const { return Numbers::number(root(squared(range) - q2_)); }
  /// Angle about the foot point from the begin to the end of all arcs.
  template <class N>
  N arcs_length(const N& t, const N& t2) const;

 protected:
  struct Arc {
    Crossing begin, end;
    Number constant;  ///< whole turns; with constants_apart, the length without the turns of the two ends
  };

  bool find_arcs(std::span<const Crossing> crossings, const Number& t);
  /// Angle from the normal of an edge to a crossing.
  template <class N>
  N turn(std::uint32_t edge, const N& t, const N& t2) const {
    const N s = edge == q_edge_ ? t : root(t2 + N(beyond2_[edge]));
    return Numbers::turn(polygon_->edges[edge].height, s);
  }
  template <class N>
  N angle_at(const Crossing& c, const N& t, const N& t2) const {
    const Number& direction = polygon_->edges[c.edge].angle;
    const N turned = turn(c.edge, t, t2);
    return c.rising ? N(direction) - turned : N(direction + Numbers::pi()) + turned;
  }
  /// Distance from the foot point.
  template <class N>
  N rho_at(const N& t, const N& t2) const {
    return full_circle_ ? t : root(N(rho_q2_) + t2);
  }

  const Polygon* polygon_ = nullptr;
  Number distance_;
  Fine distance2_, q2_;
  std::uint32_t q_edge_ = 0;
  bool full_circle_ = false;
  Number range_q2_, rho_q2_;     // q^2, and the same about the foot point
  std::vector<Number> beyond2_;  // q^2 - nearest2 of each edge
  std::vector<Arc> arcs_;

 private:
  std::vector<std::pair<Number, Crossing>> sorted_;
};

template <class Numbers>
bool PolarArcs<Numbers>::prepare(std::span<const Crossing> crossings, const PolarSlabs::Slab& slab) {
  const auto& edges = polygon_->edges;
  full_circle_ = crossings.empty();
  arcs_.clear();
  q_edge_ = std::uint32_t(edges.size());
  q2_ = distance2_;
  rho_q2_ = Number();
  if (!full_circle_) {
    q_edge_ = crossings.front().edge;
    for (const Crossing& c : crossings)
      if (edges[c.edge].nearest2.middle() > edges[q_edge_].nearest2.middle()) q_edge_ = c.edge;
    q2_ = edges[q_edge_].nearest2;
    rho_q2_ = Numbers::rho_q2(edges[q_edge_], distance2_);
    beyond2_.resize(edges.size());
    for (const Crossing& c : crossings) beyond2_[c.edge] = Numbers::number(q2_ - edges[c.edge].nearest2);
  }
  range_q2_ = Numbers::number(q2_);
  return full_circle_ || find_arcs(crossings, t_at(Fine(slab.lo + (slab.hi - slab.lo) / 2)));
}

/// Pairs the crossings on a circle in the middle of a slab. The pairs hold in the whole slab.
template <class Numbers>
bool PolarArcs<Numbers>::find_arcs(std::span<const Crossing> crossings, const Number& t) {
  const Number t2 = squared(t), two_pi = Numbers::two_pi();
  const auto turns_in = [](double angle) { return std::floor(angle / (2 * std::numbers::pi)); };
  sorted_.clear();
  std::size_t rising = 0;
  for (const Crossing& c : crossings) {
    const Number angle = angle_at(c, t, t2);
    if (!Numbers::is_direction(angle)) return false;
    sorted_.emplace_back(angle - two_pi * Number(turns_in(angle.middle())), c);
    rising += c.rising;
  }
  if (2 * rising != sorted_.size()) return false;
  std::sort(sorted_.begin(), sorted_.end(),
            [](const auto& a, const auto& b) { return a.first.middle() < b.first.middle(); });
  // With a single arc no confusion is possible. Otherwise the order must be certain.
  if (sorted_.size() > 2) {
    for (std::size_t k = 0; k + 1 < sorted_.size(); ++k)
      if (!(sorted_[k + 1].first - sorted_[k].first).surely_positive() ||
          sorted_[k].second.rising == sorted_[k + 1].second.rising)
        return false;
    if (!(sorted_.front().first + two_pi - sorted_.back().first).surely_positive()) return false;
  }
  const auto take = [&](const Crossing& begin, const Crossing& end) {
    const Number length = angle_at(end, t, t2) - angle_at(begin, t, t2);
    const double least = polygon_->foot_inside ? 0 : -1.5;
    const Number turns = two_pi * Number(-turns_in(length.middle() - least)), arc = length + turns;
    // About a foot point outside of the polygon, an arc is at most half a circle, so a thin arc cannot be a
    // whole turn. About a foot point inside, the arc must certainly be neither empty nor a whole turn.
    if (polygon_->foot_inside && !(arc.surely_positive() && (two_pi - arc).surely_positive())) return false;
    const auto& edges = polygon_->edges;
    if constexpr (Numbers::constants_apart)
      arcs_.push_back({begin, end, edges[end.edge].angle - edges[begin.edge].angle + Numbers::pi() + turns});
    else
      arcs_.push_back({begin, end, turns});
    return true;
  };
  return pair_crossings<Number>(sorted_, take);
}

template <class Numbers>
template <class N>
N PolarArcs<Numbers>::arcs_length(const N& t, const N& t2) const {
  if (full_circle_) return N(Numbers::two_pi());
  N sum;
  for (const Arc& arc : arcs_)
    if constexpr (Numbers::constants_apart)
      sum += arc.constant + (turn(arc.begin.edge, t, t2) + turn(arc.end.edge, t, t2));
    else
      sum += angle_at(arc.end, t, t2) - angle_at(arc.begin, t, t2) + N(arc.constant);
  return sum;
}

}  // namespace tubefoot
