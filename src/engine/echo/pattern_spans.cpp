// SPDX-License-Identifier: GPL-3.0-or-later
// Integrates over arcs without nodes. Along an arc the cosine w to the array is level + R cos(angle), so
//
//     d angle / d w = 1 / s(w),   s^2 = R^2 - (w - level)^2.
//
// With an origin w0 in the arc, z = w - w0, c = w0 - level and s = s(w0),
//
//     1 / s(w) = 1/s (1 - (2 c z + z^2) / s^2)^(-1/2) = 1/s (1 + c/s^2 z + (1/(2 s^2) + 3/2 (c/s^2)^2) z^2
//                + (3/2 c/s^4 + 5/2 c^3/s^6) z^3 + ...).
//
// Gains are polynomials of w over a panel (gain_panels.hpp), so their integral over the arc follows from its
// two ends. The singularities are at z = +-R - c. Coefficient k is therefore at most (R - |c|)^-k / s, and a
// geometric series bounds the truncation error.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "engine/echo/pattern_integral.hpp"
#include "engine/scattering/density.hpp"

namespace tubefoot {
namespace {

/// Share of the tolerance for the truncation of the series, and for the rounding of the ends.
constexpr double share_of_tolerance = 0.25;
constexpr double rounding = 4e-16;  // of a cosine

/// e^x for small |x|, with an error of 1e-12.
constexpr double smallest_for_library = 0.01;
double exp_of_little(double x) {
  return 1 + x * (1 + x * (1.0 / 2 + x * (1.0 / 6 + x * (1.0 / 24 + x * (1.0 / 120)))));
}

/// Cosine of an end.
template <class End>
double end_at(const End& end, double t2, double per_r) {
  return (end.level + end.slope * std::sqrt(std::max(t2 + end.gap, 0.0))) * per_r;
}

}  // namespace

/// Whether all factors on the current polygon are smooth functions of one cosine.
bool PatternIntegrator::arcs_may_be_spans() const {
  if (!receiver_->moments || !receiver_->transmit.empty() || texture_.field != nullptr) return false;
  if (piece_.foot_inside || receiver_->changes.size() != 1) return false;
  const Change& change = receiver_->changes.front();
  return change.along_axis && change.axis == receiver_->moments_axis;
}

/// As nodes_along(), for the ends of the only arc.
int PatternIntegrator::nodes_along_spans(double t0, double t1, double rho) {
  const Axis& axis = receiver_->axes[receiver_->moments_axis];
  const double middle = (t0 + t1) / 2;
  const std::array<double, 3> t2{t0 * t0, middle * middle, t1 * t1};
  for (std::size_t i = 0; i < 3; ++i) sweep_.per_r[i] = 1 / std::sqrt(piece_.q2 + t2[i]);
  double extent = 0;
  for (std::size_t k = 0; k < 2; ++k) {
    const Crossing& crossing = k == 0 ? arcs_.front().begin : arcs_.front().end;
    const Edge& edge = edges_[crossing.edge];
    const double slope = glm::dot(axis.plane, edge.along);
    Sweep::End& end = sweep_.end[k];
    end.level = axis.away + edge.height * glm::dot(axis.plane, edge.aside);
    end.slope = crossing.rising ? slope : -slope;
    end.gap = piece_.q2 - edge.nearest2;
    std::array<double, 3>& w = end.cosine;
    for (std::size_t i = 0; i < 3; ++i) w[i] = end_at(end, t2[i], sweep_.per_r[i]);
    const double curved = std::abs(w[0] - 2 * w[1] + w[2]) / 2;
    extent = std::max(extent, std::abs(w[2] - w[0]) / 2 + 4 * curved);
  }
  const Change& change = receiver_->changes.front();
  const int model =
      piece_.model != nullptr ? nodes_of_model(t0, t1, sweep_.per_r[0] / sweep_.per_r[2], rho) : 1;
  return model + change.count.nodes(extent * change.scale, rho) - 1;
}

/// Adds the arcs from t0 to t1. Returns false and adds nothing if the angle is not a smooth function of the
/// cosine over these arcs.
bool PatternIntegrator::add_spans(double t0, double t1, const GaussRule& rule) {
  const Axis& axis = receiver_->axes[receiver_->moments_axis];
  const Arc& arc = arcs_.front();
  const Sweep::End &from = sweep_.end[0], &to = sweep_.end[1];
  const auto& per_r = sweep_.per_r;
  if (!(std::abs(to.cosine[1] - from.cosine[1]) > rounding / (share_of_tolerance * tolerance_))) return false;
  const double origin = (from.cosine[1] + to.cosine[1]) / 2;
  double reach = 0;  // largest distance of cosines from the origin
  for (const Sweep::End& end : sweep_.end) {
    const std::array<double, 3>& w = end.cosine;
    const double most = std::max({std::abs(w[0] - origin), std::abs(w[1] - origin), std::abs(w[2] - origin)});
    reach = std::max(reach, most + std::abs(w[0] - 2 * w[1] + w[2]));
  }
  // R increases with range, and the level is monotonic in range.
  const double steep2 = glm::dot(axis.plane, axis.plane);
  const auto squared_radius = [&](double over_r) {
    return steep2 * (1 - piece_.distance2 * (over_r * over_r));
  };
  const double radius2 = squared_radius(per_r[0]), radius = std::sqrt(std::max(radius2, 0.0));
  const double off =
      std::max(std::abs(origin - axis.away * per_r[0]), std::abs(origin - axis.away * per_r[2]));
  const double room = radius - off;
  if (!(room > 4 * reach)) return false;
  const double per_s2 = 1 / (radius2 - off * off), ratio = reach / room;
  const double third = off * per_s2 * per_s2 * (1.5 + 2.5 * off * off * per_s2) * (reach * reach * reach),
               fourth = (ratio * ratio) * (ratio * ratio) / (1 - ratio);
  if (third + fourth > share_of_tolerance * tolerance_) return false;

  // Both ends lie on the same side of the extreme values of w on the circle, and the arc is less than half a
  // circle. Thus w is monotonic along the arc.
  const double half = (t1 - t0) / 2, middle = t0 + half;
  const auto turned_along = [&](glm::dvec2 p) { return axis.plane.y * p.x - axis.plane.x * p.y; };
  const double side = turned_along(point_at(arc.begin, middle * middle));
  if (!(side * turned_along(point_at(arc.end, middle * middle)) > 0)) return false;

  const double middle_sum = 2 / per_r[1];
  const double largest = beta_ * (2 / per_r[2] - 2 / per_r[0]);
  const bool little = largest < smallest_for_library;
  const double absorbed_there = std::exp(-(beta_ * middle_sum));

  std::array<CosineSpan, most_gauss_nodes> spans;
  const std::size_t nodes = rule.node.size();
  for (std::size_t i = 0; i < nodes; ++i) {
    const double t = middle + half * rule.node[i], t2 = t * t, r2 = piece_.q2 + t2;
    const double r = std::sqrt(r2), over_r = 1 / r, over_r2 = over_r * over_r;
    double sigma = over_r2;  // Lambert's law divided by mu and the squared distance
    if (piece_.model != nullptr)
      sigma = ScatteringModel::in_piece(
          *piece_.model, std::atan2(std::sqrt(std::max(r2 - piece_.distance2, 0.0)), piece_.distance),
          piece_.distance * over_r);
    const double absorbed =
        little ? absorbed_there * exp_of_little(beta_ * (middle_sum - 2 * r)) : std::exp(-(beta_ * (2 * r)));
    const double area = piece_.factor * (half * rule.weight[i]) * t;
    const double radial = density_ ? area * density_(r) : area * sigma * absorbed * squared(over_r2);
    const double c = origin - axis.away * over_r;
    const double per_root2 = 1 / (squared_radius(over_r) - c * c);
    const double per_root = std::copysign(std::sqrt(per_root2), side), bend = c * per_root2;
    CosineSpan& span = spans[i];
    span.begin = end_at(from, t2, over_r);
    span.end = end_at(to, t2, over_r);
    span.level[0] = radial * per_root;
    span.level[1] = span.level[0] * bend;
    span.level[2] = span.level[0] * (per_root2 / 2 + 1.5 * bend * bend);
  }
  receiver_->moments->add(std::span(spans).first(nodes), origin);
  return true;
}

}  // namespace tubefoot
