// SPDX-License-Identifier: GPL-3.0-or-later
// Certified integral of a wave F(P) of path length over a convex polygon, as an integral along its edges.
// The integrand along an edge is (2 / D) F(D) - w F(P), as in edge_form.hpp. Gauss-Legendre rules with error
// bounds from ellipses of analyticity integrate each part, or the part is halved. Undecided parts add a
// bound of their value to the radius.

#include "geometry/integrals/certified_path_wave.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/integrals/certified_rule.hpp"

namespace tubefoot {
namespace {

using Point = CertifiedPolygon::Point;

/// Limit of the halvings of an edge. A part that is still too wide adds a bound of its integral to the
/// radius.
constexpr int most_edge_halvings = 24;

ComplexBall within(double radius) {
  Ball part(0.0);
  part.add_error(Ball(radius));
  return {part, part};
}

/// Squared range from an apex along an edge. Both apexes have the same curvature.
template <class N>
N quadratic(const Ball& at_start, const Ball& slope, const Ball& curvature, const N& t) {
  return N(at_start) + t * (N(slope) + t * N(curvature));
}

/// The rule with the fewest nodes over all ellipses. `log_bound` is infinite where no bound exists.
struct Chosen {
  int nodes = most_certified_nodes + 1;
  double error = 0;
};
template <class LogBound, std::size_t size>
Chosen chosen_rule(const std::array<double, size>& rhos, double allowed, const LogBound& log_bound) {
  Chosen best;
  for (std::size_t i = 0; i < size; ++i) {
    const double log_m = log_bound(i);
    if (!std::isfinite(log_m)) break;
    const int nodes = nodes_for(rhos[i], log_m, allowed);
    if (nodes >= best.nodes) continue;
    best = {nodes, std::exp(log_m + log_error(rhos[i], nodes)) * (1 + 1e-9)};
  }
  return best;
}

double log_of(const ComplexBall& value) {
  return value.is_finite() ? std::log(std::max(value.largest(), 1e-300))
                           : std::numeric_limits<double>::infinity();
}

}  // namespace

ComplexBall PathWave::on(const Stretch& stretch, const ComplexBall& path) const {
  const ComplexBall x = path - ComplexBall(origin);
  ComplexBall sum(0.0);
  for (const Term& term : stretch.terms) sum += term.factor * exp(x * (term.linear + term.square * x));
  return sum;
}

ComplexBall PathWave::at(const Ball& path) const {
  std::optional<ComplexBall> all;
  const auto may_be = [&](const ComplexBall& value) { all = all ? hull(*all, value) : value; };
  if (stretches.empty() || !(path - stretches.front().from).surely_positive() ||
      !(stretches.back().to - path).surely_positive())
    may_be(ComplexBall(0.0));
  for (const Stretch& stretch : stretches)
    if (!(stretch.from - path).surely_positive() && !(path - stretch.to).surely_positive())
      may_be(on(stretch, ComplexBall(path)));
  return *all;
}

CertifiedPathEdges::CertifiedPathEdges(std::span<const Point> points, const Ball& height,
                                       const ApexOverPlane& rx) {
  const Ball heights = height + rx.height, share = height / heights, c_x = rx.x * share, c_y = rx.y * share;
  shortest_ = root(squared(heights) + squared(rx.x) + squared(rx.y));
  slope_x_ = rx.x / shortest_;
  slope_y_ = rx.y / shortest_;
  const Ball turn = heights / shortest_ / (Ball(4.0) * Ball::pi());
  bool surely_inside = points.size() >= 3, surely_outside = false;
  Ball twice_area(0.0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Point &a = points[i], &b = points[i + 1 == points.size() ? 0 : i + 1];
    Edge edge{a.x - c_x, a.y - c_y, b.x - a.x, b.y - a.y, {}, {}, {}, {}, {}, {}};
    const Ball left = edge.from_x * edge.step_y - edge.from_y * edge.step_x;
    edge.angle = turn * left;
    edge.length_square = squared(edge.step_x) + squared(edge.step_y);
    const auto square = [&](const Ball& x, const Ball& y, const Ball& h) {
      return squared(x) + squared(y) + squared(h);
    };
    const Ball rx_x = a.x - rx.x, rx_y = a.y - rx.y;
    edge.tx_square = square(a.x, a.y, height);
    edge.rx_square = square(rx_x, rx_y, rx.height);
    edge.tx_slope = Ball(2.0) * (a.x * edge.step_x + a.y * edge.step_y);
    edge.rx_slope = Ball(2.0) * (rx_x * edge.step_x + rx_y * edge.step_y);
    twice_area += a.x * b.y - a.y * b.x;
    surely_inside = surely_inside && left.surely_positive();
    surely_outside = surely_outside || left.surely_negative();
    // Tests whether the edge is nearer than a hundredth of its length to the point of shortest path.
    const Ball along = -(edge.from_x * edge.step_x + edge.from_y * edge.step_y) / edge.length_square;
    const Ball t = along.is_finite()
                       ? Ball::between(std::clamp(along.lo(), 0.0, 1.0), std::clamp(along.hi(), 0.0, 1.0))
                       : Ball::between(0, 1);
    const Ball nearest = squared(edge.from_x + t * edge.step_x) + squared(edge.from_y + t * edge.step_y);
    near_ = near_ || !(nearest.lo() > 1e-4 * edge.length_square.hi());
    edges_.push_back(std::move(edge));
  }
  // The opposite orientation inverts all signs, and with them the test for the point of shortest path.
  if (twice_area.middle() < 0) {
    bool right = points.size() >= 3;
    surely_outside = false;
    for (const Edge& edge : edges_) {
      right = right && edge.angle.surely_negative();
      surely_outside = surely_outside || edge.angle.surely_positive();
    }
    surely_inside = right;
  }
  inside_ = surely_inside;
  near_ = near_ || surely_inside == surely_outside;
  panels_.resize(edges_.size());

  // A path changes by at most twice the displacement along the plane. So no path to an edge is shorter than
  // half the sum of the paths to its ends, less its length.
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < edges_.size(); ++k) {
    const Edge &edge = edges_[k], &next = edges_[(k + 1) % edges_.size()];
    const Ball path = root(edge.tx_square) + root(edge.rx_square),
               end = root(next.tx_square) + root(next.rx_square),
               shortest = (path + end) / Ball(2.0) - root(edge.length_square);
    longest_path_ = std::max(longest_path_, path.hi());
    least = std::min(least, shortest.lo());
  }
  shortest_path_ = surely_inside || near_ ? shortest_.lo() : std::max(least, shortest_.lo());
}

template <class N>
CertifiedPathEdges::Place<N> CertifiedPathEdges::place(const Edge& edge, const N& t) const {
  const N tx = root(quadratic(edge.tx_square, edge.tx_slope, edge.length_square, t)),
          rx = root(quadratic(edge.rx_square, edge.rx_slope, edge.length_square, t)), d(shortest_);
  const N x = N(edge.from_x) + t * N(edge.step_x), y = N(edge.from_y) + t * N(edge.step_y),
          along = x * N(slope_x_) + y * N(slope_y_);
  return {tx + rx, tx * rx, (d - (tx - rx)) * (d + (tx - rx)), squared(x) + squared(y) - squared(along)};
}

template <class N>
N CertifiedPathEdges::weight(const Edge& edge, const Place<N>& p) const {
  return N(edge.angle) * p.across / (N(Ball(2.0) * shortest_) * p.product * p.distance);
}

CertifiedPathEdges::Panel CertifiedPathEdges::panel(double from, double to) const {
  const Ball begin(from), end(to);
  return {(begin + end) / Ball(2.0), (end - begin) / Ball(2.0), {}, {}};
}

const CertifiedPathEdges::Panel::Ellipse& CertifiedPathEdges::ellipse(const Edge& edge, Panel& panel,
                                                                      std::size_t which) const {
  std::optional<Panel::Ellipse>& kept = panel.ellipse[which];
  if (!kept) {
    const Place<ComplexBall> p = place(edge, around(panel.middle, panel.half, Panel::rhos[which]));
    kept = Panel::Ellipse{p.path, log_of(weight(edge, p))};
  }
  return *kept;
}

const std::vector<CertifiedPathEdges::Panel::Node>& CertifiedPathEdges::nodes(const Edge& edge, Panel& panel,
                                                                              int count) const {
  std::vector<Panel::Node>& kept = panel.nodes[count];
  if (kept.empty()) {
    const CertifiedRule& rule = certified_rule(count);
    for (std::size_t n = 0; n < rule.node.size(); ++n) {
      const Place<Ball> p = place(edge, panel.middle + panel.half * rule.node[n]);
      kept.push_back({p.path, rule.weight[n] * weight(edge, p)});
    }
  }
  return kept;
}

void CertifiedPathEdges::add_crossings(const Edge& edge, const Ball& path,
                                       std::vector<std::pair<double, double>>& at) const {
  if (!(path - shortest_).surely_positive() && !(path - shortest_).may_be_zero()) return;
  // The transmit range is (p + (r^2 - s^2) / p) / 2, where r^2 - s^2 is linear in t.
  const Ball square = squared(path), four = Ball(4.0) * square,
             start = square + edge.tx_square - edge.rx_square, slope = edge.tx_slope - edge.rx_slope;
  const Ball a = edge.length_square - squared(slope) / four,
             b = edge.tx_slope - Ball(2.0) * slope * start / four, c = edge.tx_square - squared(start) / four;
  if (!a.surely_positive()) return at.emplace_back(0, 1), void();
  const Ball below = squared(b) - Ball(4.0) * a * c;
  if (below.surely_negative()) return;
  const Ball away = root(below);
  for (const Ball& t : {(-b - away) / (Ball(2.0) * a), (-b + away) / (Ball(2.0) * a)}) {
    if (!t.is_finite()) return at.emplace_back(0, 1), void();
    if (t.hi() >= 0 && t.lo() <= 1) at.emplace_back(std::max(t.lo(), 0.0), std::min(t.hi(), 1.0));
  }
}

std::vector<CertifiedPathEdges::Part> CertifiedPathEdges::parts_of(const Edge& edge,
                                                                   const PathWave& wave) const {
  std::vector<std::pair<double, double>> crossings;
  for (const PathWave::Stretch& stretch : wave.stretches) add_crossings(edge, stretch.from, crossings);
  if (!wave.stretches.empty()) add_crossings(edge, wave.stretches.back().to, crossings);
  std::sort(crossings.begin(), crossings.end());
  std::vector<Part> parts;
  const auto add_between = [&](double from, double to) {
    if (!(from < to)) return;
    const Ball path = place(edge, Ball((from + to) / 2)).path;
    Part part{from, to, nullptr, false};
    bool sure = wave.stretches.empty() || (wave.stretches.front().from - path).surely_positive() ||
                (path - wave.stretches.back().to).surely_positive();
    for (const PathWave::Stretch& stretch : wave.stretches)
      if ((path - stretch.from).surely_positive() && (stretch.to - path).surely_positive()) {
        part.stretch = &stretch;
        sure = true;
      }
    part.gap = !sure;
    parts.push_back(part);
  };
  double done = 0;
  for (const auto& [from, to] : crossings) {
    add_between(done, from);
    if (std::max(from, done) < to) parts.push_back({std::max(from, done), to, nullptr, true});
    done = std::max(done, to);
  }
  add_between(done, 1);
  return parts;
}

ComplexBall CertifiedPathEdges::far(std::size_t number, const PathWave& wave,
                                    const PathWave::Stretch& stretch, double from, double to, double allowed,
                                    int halvings, bool kept) {
  const Edge& edge = edges_[number];
  std::optional<Panel> own;
  if (!kept) own = panel(from, to);
  const auto found =
      kept ? panels_[number].try_emplace({from, to}, panel(from, to)).first : panels_[number].end();
  Panel& at = kept ? found->second : *own;
  const Chosen rule = chosen_rule(Panel::rhos, allowed, [&](std::size_t i) {
    const Panel::Ellipse& e = ellipse(edge, at, i);
    return std::isfinite(e.log_weight) ? e.log_weight + log_of(wave.on(stretch, e.path)) : e.log_weight;
  });
  if (rule.nodes > most_certified_nodes) {
    const double middle = (from + to) / 2;
    if (halvings == most_edge_halvings || !(from < middle && middle < to)) {
      const Place<Ball> p = place(edge, Ball::between(from, to));
      return -(ComplexBall((Ball(to) - Ball(from)) * weight(edge, p)) *
               wave.on(stretch, ComplexBall(p.path)));
    }
    return far(number, wave, stretch, from, middle, allowed, halvings + 1, kept) +
           far(number, wave, stretch, middle, to, allowed, halvings + 1, kept);
  }
  ComplexBall sum = within(rule.error);
  for (const Panel::Node& node : nodes(edge, at, rule.nodes))
    sum += ComplexBall(node.weight) * wave.on(stretch, ComplexBall(node.path));
  return -(ComplexBall(at.half) * sum);
}

/// Bound of the integral over a part in which F may have kinks or jumps.
ComplexBall CertifiedPathEdges::rest(const Edge& edge, const PathWave& wave, double from, double to) const {
  const Place<Ball> p = place(edge, Ball::between(from, to));
  const Ball width = Ball(to) - Ball(from), straight = edge.angle / p.across;
  const Ball second = width * straight * Ball(2.0) * shortest_ / p.product * Ball(wave.largest);
  // |F(D) - F(P)| is at most steepest * (P - D). For a wave that jumps, the bound is twice the largest
  // value, over at most half a turn.
  const Ball first = std::isfinite(wave.steepest) ? width * straight * Ball(8.0) * shortest_ /
                                                        (p.path + shortest_) * Ball(wave.steepest)
                                                  : Ball(wave.largest) / shortest_;
  return within(std::max(std::abs(first.lo()), std::abs(first.hi())) +
                std::max(std::abs(second.lo()), std::abs(second.hi())));
}

ComplexBall CertifiedPathEdges::near(const Edge& edge, const PathWave& wave, const ComplexBall& at_shortest,
                                     const PathWave::Stretch* of_shortest, const Part& part,
                                     double allowed) const {
  const ComplexBall d(shortest_), angle(edge.angle), origin(wave.origin), x0 = d - origin;
  // P - D = 4 D^2 (distance from the line)^2 / (across (P + D)). This form avoids a division by P - D where
  // both paths lie on one stretch.
  const auto regular = [&](const ComplexBall& t) {
    const Place<ComplexBall> p = place(edge, t);
    const ComplexBall x = p.path - origin;
    ComplexBall wave_there(0.0), quotient(0.0);
    for (const PathWave::Term& term : part.stretch->terms) {
      const ComplexBall here = x * (term.linear + term.square * x),
                        there = x0 * (term.linear + term.square * x0),
                        slope = term.linear + term.square * (x + x0);
      const ComplexBall longer = ComplexBall(4.0) * d * d * p.distance / (p.across * (p.path + d));
      const ComplexBall half = longer * slope / ComplexBall(2.0);
      wave_there += term.factor * exp(here);
      quotient += term.factor * slope * exp((here + there) / ComplexBall(2.0)) *
                  sinc(half * ComplexBall(Ball(0.0), Ball(1.0)));
    }
    return angle / p.across *
           (ComplexBall(2.0) * d * wave_there / p.product - ComplexBall(8.0) * d * quotient / (p.path + d));
  };
  const auto plain = [&](const ComplexBall& t) {
    const Place<ComplexBall> p = place(edge, t);
    ComplexBall value = ComplexBall(2.0) / d * at_shortest * angle / p.distance;
    if (part.stretch != nullptr) value = value - weight(edge, p) * wave.on(*part.stretch, p.path);
    return value;
  };
  const bool same = part.stretch == of_shortest;
  const auto value_at = [&](const ComplexBall& t) {
    return same && part.stretch != nullptr ? regular(t) : plain(t);
  };
  const auto over = [&](const auto& self, double from, double to, int halvings) -> ComplexBall {
    const Panel at = panel(from, to);
    const Chosen rule = chosen_rule(Panel::rhos, allowed, [&](std::size_t i) {
      return log_of(value_at(around(at.middle, at.half, Panel::rhos[i])));
    });
    if (rule.nodes > most_certified_nodes) {
      const double middle = (from + to) / 2;
      if (halvings == most_edge_halvings || !(from < middle && middle < to))
        return rest(edge, wave, from, to);
      return self(self, from, middle, halvings + 1) + self(self, middle, to, halvings + 1);
    }
    const CertifiedRule& nodes = certified_rule(rule.nodes);
    ComplexBall sum = within(rule.error);
    for (std::size_t n = 0; n < nodes.node.size(); ++n)
      sum += ComplexBall(nodes.weight[n]) * value_at(ComplexBall(at.middle + at.half * nodes.node[n]));
    return ComplexBall(at.half) * sum;
  };
  return over(over, part.from, part.to, 0);
}

ComplexBall CertifiedPathEdges::integral(const PathWave& wave, double allowed) {
  ComplexBall sum(0.0);
  const ComplexBall at_shortest = wave.at(shortest_);
  const PathWave::Stretch* of_shortest = nullptr;
  for (const PathWave::Stretch& stretch : wave.stretches)
    if ((shortest_ - stretch.from).surely_positive() && (stretch.to - shortest_).surely_positive())
      of_shortest = &stretch;
  const bool silent = at_shortest.largest() == 0;
  // One turn about the point of shortest path contributes 1/2 of 2 / D.
  if (!near_ && inside_)
    sum += edges_.front().angle.surely_positive() ? at_shortest / ComplexBall(shortest_)
                                                  : -(at_shortest / ComplexBall(shortest_));
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    const Edge& edge = edges_[i];
    const std::vector<Part> parts = parts_of(edge, wave);
    for (const Part& part : parts) {
      if (part.gap) {
        const Place<Ball> p = place(edge, Ball::between(part.from, part.to));
        ComplexBall value = -(ComplexBall(weight(edge, p)) * wave.at(p.path));
        if (near_) value += ComplexBall(Ball(2.0) / shortest_ * edge.angle / p.distance) * at_shortest;
        value = ComplexBall(Ball(part.to) - Ball(part.from)) * value;
        sum += near_ && !value.is_finite() ? rest(edge, wave, part.from, part.to) : value;
      } else if (near_) {
        if (part.stretch != nullptr || !silent)
          sum += near(edge, wave, at_shortest, of_shortest, part, allowed);
      } else if (part.stretch != nullptr) {
        sum += far(i, wave, *part.stretch, part.from, part.to, allowed, 0, parts.size() == 1);
      }
    }
  }
  return sum;
}

}  // namespace tubefoot
