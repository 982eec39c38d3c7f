// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/gradient/certified_edges.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/integrals/certified_rule.hpp"

// Encloses integrals along edges. Their integrands are analytic on both sides of the point of an edge's line
// that is nearest to the apex. Parts that a rule does not enclose are halved.

namespace tubefoot {
namespace {

/// Relative error of the rules. It is far below the error of the energies.
constexpr double rule_tolerance = 1e-22;
constexpr std::size_t most_edge_halvings = 1000;

/// sinh(x) / x.
ComplexBall sinh_ratio(const ComplexBall& x) { return sinc(ComplexBall(Ball(0), Ball(1)) * x); }
Ball sinh_ratio(const Ball& x) { return sinh_ratio(ComplexBall(x)).real(); }

bool is_lower(const Ball& a, const Ball& b) { return arf_cmp(arb_midref(a.get()), arb_midref(b.get())) < 0; }

/// The part of a ball that is not below 0, for a number that is known not to be negative.
Ball not_negative(const Ball& x) { return x.surely_positive() ? x : Ball::between(0, std::max(x.hi(), 0.0)); }

/// Encloses a fraction from 0 to 1 of a number.
Ball fraction_of(const Ball& x) { return hull(Ball(0), x); }

}  // namespace

std::size_t CertifiedEdges::bin_of(double range) const {
  if (range < borders_.front() || range >= borders_.back()) return none();
  return std::size_t(std::upper_bound(borders_.begin(), borders_.end(), range) - borders_.begin()) - 1;
}

template <class N>
std::array<N, 2> CertifiedEdges::density_and_turn(const N& r2, const N& rho2, bool at_foot) const {
  const N u = N(Ball(1)) / r2, r = root(r2), beta(beta_);
  const bool absorbs = beta_.surely_positive();
  const N left = absorbs ? exp(-(beta * (r + r))) : N(Ball(1));
  const N density = u * u * u * left;
  if (!at_foot) return {density, density / rho2};
  const N foot = N(Ball(1) / distance2_), distance(distance_);
  N turn = -(u * foot * (u * u + u * foot + foot * foot) * left);
  if (absorbs)
    turn += -(N(Ball(2)) * beta * foot * foot * foot * exp(-(beta * (r + distance))) *
              sinh_ratio(beta * (r - distance)) / (r + distance));
  return {density, turn};
}

template <class N>
std::array<N, 2> CertifiedEdges::on_edge(const Edge& edge, const N& t, bool at_foot) const {
  const N along2 = N(edge.length2) * squared(t - N(edge.t0));
  return density_and_turn<N>(N(edge.nearest2) + along2, N(edge.aside2) + along2, at_foot);
}

bool CertifiedEdges::try_rule(const Edge& edge, const Ball& middle, const Ball& half, bool at_foot,
                              Integrals& sum) const {
  const double width = half.hi();
  const auto [f, w] = on_edge(edge, middle, at_foot);
  const double f_here = std::abs(f.middle()), w_here = std::abs(w.middle());
  const double across =
      std::sqrt(std::max((at_foot ? edge.nearest2 : edge.aside2).middle() / edge.length2.middle(), 0.0));
  double rho = largest_rho(std::abs((middle - edge.t0).middle()), across, width);
  for (int attempt = 0; attempt < 3 && rho > 1.3; ++attempt, rho = 1 + (rho - 1) / 3) {
    const ComplexBall box = around(middle, half, rho);
    const auto [f_box, w_box] = on_edge(edge, box, at_foot);
    const double most[3] = {f_box.largest(), f_box.largest() * box.largest() * (1 + 1e-15), w_box.largest()};
    const double allowed[3] = {f_here, f_here, w_here};
    int nodes = fewest_certified_nodes;
    for (int k = 0; k < 3; ++k)
      nodes = std::max(nodes, std::isfinite(most[k])
                                  ? nodes_for(rho, std::log(most[k]), rule_tolerance * allowed[k])
                                  : most_certified_nodes + 1);
    if (nodes > most_certified_nodes) continue;
    const CertifiedRule& rule = certified_rule(nodes);
    Integrals part;
    for (std::size_t k = 0; k < rule.node.size(); ++k) {
      const Ball t = middle + half * rule.node[k];
      const auto [density, turn] = on_edge(edge, t, at_foot);
      part[0] += rule.weight[k] * density;
      part[1] += rule.weight[k] * density * t;
      part[2] += rule.weight[k] * turn;
    }
    const Ball error = exp(Ball(log_error(rho, nodes)));
    for (std::size_t k = 0; k < 3; ++k) {
      part[k].add_error(Ball(most[k]) * error);
      if (!part[k].is_finite()) return false;
    }
    for (std::size_t k = 0; k < 3; ++k) sum[k] += half * part[k];
    return true;
  }
  return false;
}

auto CertifiedEdges::integral(const Edge& edge, const Ball& from, const Ball& to, bool at_foot) const
    -> Integrals {
  Integrals sum;
  std::vector<std::pair<Ball, Ball>> work{{from, to}};
  // Stretches are taken in order of creation, so that those left at the limit are small.
  for (std::size_t next = 0; next < work.size(); ++next) {
    const auto [begin, end] = work[next];
    const Ball length = end - begin, half = length / Ball(2), middle = begin + half;
    if (try_rule(edge, middle, half, at_foot, sum)) continue;
    if (work.size() < 2 * most_edge_halvings) {
      work.emplace_back(begin, middle.centre());
      work.emplace_back(middle.centre(), end);
      continue;
    }
    const Ball t = hull(begin, end);
    const auto [f, w] = on_edge(edge, t, at_foot);
    sum[0] += length * f;
    sum[1] += length * f * t;
    sum[2] += length * w;
  }
  return sum;
}

void CertifiedEdges::take_part(const Edge& edge, std::size_t bin, const Integrals& integrals,
                               const Take& take) const {
  Part part{bin, edge.number, {}, {}, {}};
  const Ball first = integrals[0] - integrals[1];
  part.by_first = {first * edge.along[1], -(first * edge.along[0])};
  part.by_second = {integrals[1] * edge.along[1], -(integrals[1] * edge.along[0])};
  part.by_distance = distance_ * edge.turn * integrals[2];
  take(part);
}

void CertifiedEdges::take_angle(const Edge& edge, const Ball& from, const Ball& to, const Take& take) const {
  const auto at = [&](const Ball& t, std::size_t k) { return edge.first[k] + t * edge.along[k]; };
  const Ball together = at(from, 0) * at(to, 0) + at(from, 1) * at(to, 1);
  const Ball angle = atan2(edge.turn * (to - from), together);
  take({foot_bin_, edge.number, {}, {}, -(distance_ * at_foot_ * angle)});
}

void CertifiedEdges::take_doubtful(const Edge& edge, const Ball& t, const Take& take) const {
  Ball length;
  arb_get_rad_arb(length.get(), t.get());
  length = Ball(2) * length;
  const Ball x = edge.first[0] + t * edge.along[0], y = edge.first[1] + t * edge.along[1];
  const Ball rho2 = not_negative(x * x + y * y), r2 = distance2_ + rho2, r = root(r2);
  const auto enclose = [&](std::size_t bin, bool at_foot) {
    const auto [f, w] = density_and_turn<Ball>(r2, rho2, at_foot);
    take_part(edge, bin, {fraction_of(length * f), fraction_of(length * f * t), fraction_of(length * w)},
              take);
  };
  for (std::size_t bin = 0; bin < none(); ++bin)
    if (borders_[bin] <= r.hi() && borders_[bin + 1] >= r.lo()) enclose(bin, bin == foot_bin_);
  // The angle of a part outside of the bin of the foot point counts for that bin.
  if (foot_bin_ == none() || !(r.hi() >= borders_[foot_bin_ + 1] || r.lo() <= borders_[foot_bin_])) return;
  const Ball angle = length * edge.turn / rho2;
  take({foot_bin_, edge.number, {}, {}, fraction_of(-(distance_ * at_foot_ * angle))});
}

void CertifiedEdges::find_breaks(const Edge& edge) {
  sorted_.assign({{Ball(0), true}, {Ball(1), true}});
  const auto range_at = [&](int end) {
    return root(edge.nearest2 + edge.length2 * squared(Ball(end) - edge.t0)).hi();
  };
  const double nearest = root(edge.nearest2).lo(), farthest = std::max(range_at(0), range_at(1));
  for (const double border : borders_) {
    if (border < nearest || border > farthest) continue;
    const Ball square = (squared(Ball(border)) - edge.nearest2) / edge.length2;
    if (square.surely_negative()) continue;
    const Ball s = root(not_negative(square));
    const auto add = [&](const Ball& t, bool certain) {
      if (!t.surely_negative() && !(Ball(1) - t).surely_negative()) sorted_.push_back({t, certain});
    };
    if (square.surely_positive()) {
      add(edge.t0 - s, true);
      add(edge.t0 + s, true);
    } else {
      add(edge.t0 + hull(-s, s), false);
    }
  }
  std::sort(sorted_.begin(), sorted_.end(),
            [](const Break& a, const Break& b) { return is_lower(a.t, b.t); });
  // Breaks whose order is not certain become one.
  breaks_.clear();
  for (Break next : sorted_) {
    while (!breaks_.empty() && !(next.t - breaks_.back().t).surely_positive()) {
      next = {hull(breaks_.back().t, next.t), false};
      breaks_.pop_back();
    }
    breaks_.push_back(std::move(next));
  }
}

void CertifiedEdges::add_edge(const Edge& edge, const Take& take) {
  find_breaks(edge);
  for (std::size_t k = 0; k < breaks_.size(); ++k) {
    const Ball& from = breaks_[k].t;
    if (!breaks_[k].certain) take_doubtful(edge, from, take);
    if (k + 1 == breaks_.size()) break;
    const Ball& to = breaks_[k + 1].t;
    const Ball middle = ((from + to) / Ball(2)).centre();
    const Ball range = root(edge.nearest2 + edge.length2 * squared(middle - edge.t0));
    const std::size_t bin = bin_of(range.lo());
    if (bin != bin_of(range.hi())) {
      take_doubtful(edge, hull(from, to), take);
      continue;
    }
    if (bin != none()) take_part(edge, bin, integral(edge, from, to, bin == foot_bin_), take);
    if (bin != foot_bin_ && foot_bin_ != none()) take_angle(edge, from, to, take);
  }
}

void CertifiedEdges::add(const CertifiedPolygon& polygon, const Take& take) {
  distance_ = polygon.distance;
  distance2_ = squared(distance_);
  at_foot_ = exp(-(Ball(2) * beta_ * distance_)) / (distance2_ * distance2_ * distance2_);
  foot_bin_ = bin_of(distance_.hi());
  const std::size_t corners = polygon.points.size();
  for (std::size_t k = 0; k < corners; ++k) {
    const auto &a = polygon.points[k], &b = polygon.points[(k + 1) % corners];
    Edge edge;
    edge.number = k;
    edge.first = {a.x, a.y};
    edge.along = {b.x - a.x, b.y - a.y};
    edge.length2 = squared(edge.along[0]) + squared(edge.along[1]);
    edge.turn = a.x * edge.along[1] - a.y * edge.along[0];
    if (!edge.length2.surely_positive()) {
      take_doubtful(edge, Ball::between(0, 1), take);
      continue;
    }
    edge.t0 = -((a.x * edge.along[0] + a.y * edge.along[1]) / edge.length2);
    edge.aside2 = squared(edge.turn) / edge.length2;
    edge.nearest2 = distance2_ + edge.aside2;
    add_edge(edge, take);
  }
  // A foot point on a range border, which may lie in the polygon, may count for the bin before the border.
  const std::size_t before = bin_of(std::nextafter(distance_.lo(), 0));
  if (before == foot_bin_ || !polygon.foot) return;
  const Ball most = Ball(2) * Ball::pi() * distance_ * at_foot_;
  if (foot_bin_ != none()) take({foot_bin_, 0, {}, {}, fraction_of(most)});
  if (before != none()) take({before, 0, {}, {}, fraction_of(-most)});
}

}  // namespace tubefoot
