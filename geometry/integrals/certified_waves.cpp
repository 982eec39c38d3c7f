// SPDX-License-Identifier: GPL-3.0-or-later
// Certified phasors, means of phasors over triangles, transforms of polygons and edge-form integrals of
// e^{ikP}. The formulas are those of polygon_transform.hpp and edge_form.hpp; ball arithmetic encloses all
// rounding and truncation.

#include "geometry/integrals/certified_waves.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/integrals/certified_rule.hpp"

namespace tubefoot {
namespace {

const ComplexBall imaginary_unit(Ball(0.0), Ball(1.0));

/// The mean over a segment is e^{i (a + b) / 2} sinc((b - a) / 2).
ComplexBall mean_of_two(const Ball& a, const Ball& b) {
  return certified_phasor((a + b) / Ball(2.0)) * sinc(ComplexBall((b - a) / Ball(2.0)));
}

/// 2 sum of i^k h_k / (k + 2)!, as in mean_phasor(). From |h_k| <= (k + 1)(k + 2) / 2 largest^k, the
/// truncation error after k terms is at most largest^k / k! / (1 - largest / (k + 1)).
ComplexBall series(const Ball& x, const Ball& y, const Ball& z) {
  const Ball e1 = x + y + z, e2 = x * y + z * (x + y), e3 = x * y * z;
  const auto size = [](const Ball& b) { return std::max(std::abs(b.lo()), std::abs(b.hi())); };
  const double largest = std::max({size(x), size(y), size(z)});
  Ball before2(0.0), before1(0.0), now(1.0), weight(1.0);
  ComplexBall sum(1.0), power(1.0);
  Ball bound(1.0);
  for (int k = 1; k <= 200; ++k) {
    const Ball next = e1 * now - e2 * before1 + e3 * before2;
    before2 = before1;
    before1 = now;
    now = next;
    weight = weight / Ball(static_cast<double>(k + 2));
    power = power * imaginary_unit;
    sum += power * ComplexBall(now * weight);
    bound = bound * Ball(largest) / Ball(static_cast<double>(k));
    if (k > largest + 1 && bound.hi() < 1e-40) break;
  }
  // If 200 terms do not suffice, the enclosure is wide but correct: for phases below 100 the further terms
  // decrease at least by half each.
  Ball real = sum.real(), imaginary = sum.imaginary();
  const Ball rest = largest < 100 ? bound * Ball(2.0) : Ball(std::numeric_limits<double>::infinity());
  real.add_error(rest);
  imaginary.add_error(rest);
  return {real, imaginary};
}

/// A directed edge relative to the point c of shortest path, and both apexes over the plane.
struct EdgeOfWave {
  Ball from_x, from_y, step_x, step_y;  ///< relative to c
  Ball tx_x, tx_y, tx_height, rx_x, rx_y, rx_height;
  Ball shortest, k;
  Ball angle;  ///< turn times cross(from, step) / 4 pi

  /// Derivative of the integral by t, from 0 to 1 along the edge. Here longer = P - D, and per_square is
  /// longer over the squared distance from the line through c. This form is regular where that distance is
  /// 0.
  ComplexBall at(const ComplexBall& t) const {
    const ComplexBall x = ComplexBall(from_x) + t * ComplexBall(step_x),
                      y = ComplexBall(from_y) + t * ComplexBall(step_y), d(shortest);
    const auto range = [&](const Ball& foot_x, const Ball& foot_y, const Ball& height) {
      return root(squared(x - ComplexBall(foot_x)) + squared(y - ComplexBall(foot_y)) +
                  ComplexBall(squared(height)));
    };
    const ComplexBall r = range(tx_x, tx_y, tx_height), s = range(rx_x, rx_y, rx_height);
    const ComplexBall across = (d - (r - s)) * (d + (r - s)), total = r + s + d;
    const ComplexBall per_square = ComplexBall(4.0) * d * d / (across * total);
    const ComplexBall longer = r + s - d, ik = imaginary_unit * ComplexBall(k);
    const ComplexBall wave = exp(ik * (r + s));
    // (F(P) - F(D)) / (P - D)
    const ComplexBall quotient =
        ik * exp(ik * total / ComplexBall(2.0)) * sinc(ComplexBall(k) * longer / ComplexBall(2.0));
    return ComplexBall(angle) * per_square *
           (total * wave / (ComplexBall(2.0) * d * r * s) - ComplexBall(2.0) / d * quotient);
  }
};

/// Adds the integral over t in [from, to]. Returns false if no rule encloses it.
bool add_edge(const EdgeOfWave& edge, double from, double to, double allowed, int halvings,
              ComplexBall& sum) {
  const Ball middle((from + to) / 2), half((to - from) / 2);  // exact, because the bounds are dyadic
                                                              // fractions
  int fewest = most_certified_nodes + 1;
  double error = 0;
  for (const double rho : {2.5, 4.0, 7.0, 13.0, 30.0}) {
    const ComplexBall value = edge.at(around(middle, half, rho));
    if (!value.is_finite()) break;
    const double log_m = std::log(std::max(value.largest(), 1e-300));
    const int nodes = nodes_for(rho, log_m, allowed);
    if (nodes >= fewest) continue;
    fewest = nodes;
    error = std::exp(log_m + log_error(rho, nodes)) * (1 + 1e-9);
  }
  if (fewest > most_certified_nodes) {
    constexpr int most_halvings = 24;
    if (halvings == most_halvings) return false;
    return add_edge(edge, from, (from + to) / 2, allowed, halvings + 1, sum) &&
           add_edge(edge, (from + to) / 2, to, allowed, halvings + 1, sum);
  }
  const CertifiedRule& rule = certified_rule(fewest);
  ComplexBall panel(0.0);
  for (std::size_t n = 0; n < rule.node.size(); ++n)
    panel += ComplexBall(rule.weight[n]) * edge.at(ComplexBall(middle + half * rule.node[n]));
  Ball real = panel.real(), imaginary = panel.imaginary();
  real.add_error(Ball(error));
  imaginary.add_error(Ball(error));
  sum += ComplexBall(half) * ComplexBall(real, imaginary);
  return true;
}

}  // namespace

ComplexBall certified_phasor(const Ball& phase) {
  Ball sine, cosine;
  sin_cos(phase, sine, cosine);
  return {cosine, sine};
}

ComplexBall certified_mean_phasor(const std::array<Ball, 3>& phases) {
  // Sorts the phases by their middles, so that p[0] and p[2] differ most.
  std::array<Ball, 3> p = phases;
  std::sort(p.begin(), p.end(), [](const Ball& a, const Ball& b) { return a.middle() < b.middle(); });
  constexpr double apart = 2;
  if (const Ball spread = p[2] - p[0]; spread.lo() >= apart) {
    const ComplexBall change = mean_of_two(p[1], p[2]) - mean_of_two(p[0], p[1]);
    return change * imaginary_unit * ComplexBall(Ball(-2.0) / spread);
  }
  const Ball middle = ((p[0] + p[1] + p[2]) / Ball(3.0)).centre();
  return certified_phasor(middle) * series(p[0] - middle, p[1] - middle, p[2] - middle);
}

ComplexBall certified_transform(std::span<const CertifiedPolygon::Point> points, const Ball& gradient_x,
                                const Ball& gradient_y) {
  ComplexBall sum(0.0);
  const auto phase = [&](const CertifiedPolygon::Point& p) { return p.x * gradient_x + p.y * gradient_y; };
  for (std::size_t i = 2; i < points.size(); ++i) {
    const CertifiedPolygon::Point &a = points[0], &b = points[i - 1], &c = points[i];
    const Ball area = ((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)) / Ball(2.0);
    sum += ComplexBall(area) * certified_mean_phasor({phase(a), phase(b), phase(c)});
  }
  return sum;
}

std::optional<ComplexBall> certified_edge_form(std::span<const CertifiedPolygon::Point> points,
                                               const Ball& height, const ApexOverPlane& rx, const Ball& k,
                                               double tolerance) {
  if (!height.surely_positive() || !rx.height.surely_positive() || !(tolerance > 0)) return std::nullopt;
  ComplexBall sum(0.0);
  if (points.size() < 3) return sum;
  const Ball heights = height + rx.height, share = height / heights, c_x = rx.x * share, c_y = rx.y * share;
  const Ball shortest = root(squared(heights) + squared(rx.x) + squared(rx.y));
  const Ball turn = heights / shortest / (Ball(4.0) * Ball::pi());
  const double allowed = tolerance / shortest.hi() / static_cast<double>(points.size()) / 2;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const CertifiedPolygon::Point &a = points[i], &b = points[i + 1 == points.size() ? 0 : i + 1];
    EdgeOfWave edge{a.x - c_x,  a.y - c_y,  b.x - a.x, b.y - a.y, -c_x, -c_y,     height,
                    rx.x - c_x, rx.y - c_y, rx.height, shortest,  k,    Ball(0.0)};
    edge.angle = turn * (edge.from_x * edge.step_y - edge.from_y * edge.step_x);
    if (!add_edge(edge, 0, 1, allowed, 0, sum)) return std::nullopt;
  }
  return sum;
}

}  // namespace tubefoot
