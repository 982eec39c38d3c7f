// SPDX-License-Identifier: GPL-3.0-or-later
// Splits the edges of a polygon into panels on which the path length is monotonic, and computes quadrature
// nodes on them. The integral is image() F(D) + sum of weight F(path), with the weights of edge_form.hpp.

#include "geometry/integrals/edge_panels.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "geometry/integrals/ellipse_rule.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

constexpr int most_panel_halvings = 60;
/// Edges whose distance from the point of shortest path, times the growth, is below this limit add nothing.
/// To that accuracy the edge's integral cancels its share of the image.
constexpr double through_rad = 1e-12;

}  // namespace

void EdgePanels::assign(const PlanarPolygon& polygon, const PathCutter::Receiver& rx, double growth_per_m,
                        double most_spread_m) {
  edges_.clear();
  panels_.clear();
  image_ = 0;
  growth_per_m_ = growth_per_m;
  const double heights = polygon.distance + rx.distance;
  if (!(polygon.distance > 0) || !(rx.distance > 0) || polygon.offsets.size() < 3) return;
  const glm::dvec2 c = rx.foot * (polygon.distance / heights), tx_foot = -c, rx_foot = rx.foot - c;
  shortest_m_ = std::sqrt(heights * heights + glm::dot(rx.foot, rx.foot));
  turn_ = heights / shortest_m_;
  const glm::dvec2 tilt = rx.foot / shortest_m_;
  double angle = 0;
  const std::size_t n = polygon.offsets.size();
  for (std::size_t k = 0; k < n; ++k) {
    const glm::dvec2 step = polygon.offsets[k + 1 == n ? 0 : k + 1] - polygon.offsets[k];
    const double length = glm::length(step);
    if (!(length > 0)) continue;
    const glm::dvec2 start = polygon.first - c + polygon.offsets[k], along = step / length,
                     beside(along.y, -along.x);
    Edge edge{cross(start, along),
              glm::dot(tx_foot, along),
              glm::dot(rx_foot, along),
              0,
              0,
              glm::dot(tilt, along),
              glm::dot(tilt, beside),
              k};
    if (!(std::abs(edge.height) * growth_per_m > through_rad)) continue;
    // The point of the line nearest to c is `height * beside`.
    edge.tx_m = std::hypot(edge.height - glm::dot(tx_foot, beside), polygon.distance);
    edge.rx_m = std::hypot(edge.height - glm::dot(rx_foot, beside), rx.distance);
    const double from = glm::dot(start, along), to = from + length;
    // Integral of turn height / (squared distance from the line through c) along the edge.
    const double a = 1 - edge.tilt_along * edge.tilt_along,
                 b = -edge.height * edge.tilt_beside * edge.tilt_along, rest = std::abs(edge.height) * turn_;
    angle += std::copysign(std::atan2(a * to + b, rest) - std::atan2(a * from + b, rest), edge.height);
    const double lowest = (edge.tx_at * edge.rx_m + edge.rx_at * edge.tx_m) / (edge.tx_m + edge.rx_m);
    edges_.push_back(edge);
    if (lowest > from && lowest < to) {
      add_panels(edges_.size() - 1, from, lowest, most_spread_m, 0);
      add_panels(edges_.size() - 1, lowest, to, most_spread_m, 0);
    } else {
      add_panels(edges_.size() - 1, from, to, most_spread_m, 0);
    }
  }
  // Except for rounding, the sum is a whole turn, half a turn or none.
  const double turns = std::round(angle / pi) / 2;
  image_ = std::abs(angle / (2 * pi) - turns) < 1e-9 ? turns / shortest_m_ : angle / (2 * pi * shortest_m_);
}

double EdgePanels::path_at(const Edge& edge, double at) const {
  const double tx = at - edge.tx_at, rx = at - edge.rx_at;
  return std::sqrt(tx * tx + edge.tx_m * edge.tx_m) + std::sqrt(rx * rx + edge.rx_m * edge.rx_m);
}

void EdgePanels::add_panels(std::size_t edge, double from, double to, double most_spread_m, int halvings) {
  const double from_path = path_at(edges_[edge], from), to_path = path_at(edges_[edge], to);
  if (std::abs(to_path - from_path) > most_spread_m && halvings < most_panel_halvings) {
    const double middle = (from + to) / 2;
    add_panels(edge, from, middle, most_spread_m, halvings + 1);
    add_panels(edge, middle, to, most_spread_m, halvings + 1);
    return;
  }
  panels_.push_back({edge, from, to, from_path, to_path});
}

double EdgePanels::place_of(const Panel& panel, double path_m) const {
  const Edge& edge = edges_[panel.edge];
  const double sign = panel.to_path_m >= panel.from_path_m ? 1 : -1;
  double low = panel.from, high = panel.to;  // sign * (path - path_m) is below 0 at low
  const double share = (path_m - panel.from_path_m) / (panel.to_path_m - panel.from_path_m);
  double at = low + std::clamp(share, 0.0, 1.0) * (high - low);
  if (!std::isfinite(at)) return (low + high) / 2;
  for (int step = 0; step < most_panel_halvings; ++step) {
    const double tx = at - edge.tx_at, rx = at - edge.rx_at, r = std::hypot(tx, edge.tx_m),
                 s = std::hypot(rx, edge.rx_m), off = r + s - path_m, slope = tx / r + rx / s;
    if (std::abs(off) <= 4e-16 * path_m) return at;
    (sign * off < 0 ? low : high) = at;
    double next = at - off / slope;
    if (std::abs(next - at) <= 1e-15 * std::abs(panel.to - panel.from)) return at;
    if (!(next > low && next < high)) next = (low + high) / 2;
    at = next;
  }
  return at;
}

void EdgePanels::nodes(const Panel& panel, double from, double to, double turn_rad, double error,
                       std::vector<Node>& out) const {
  if (!(to > from)) return;
  const Edge& edge = edges_[panel.edge];
  const double half_m = std::abs(path_at(edge, to) - path_at(edge, from)) / 2;
  add_nodes(edge, from, to, growth_per_m_ + (half_m > 0 ? turn_rad / half_m : 0),
            std::log(64.0 / 15) - std::log(error), 0, out);
}

void EdgePanels::add_nodes(const Edge& edge, double from, double to, double growth_per_m, double log_error,
                           int halvings, std::vector<Node>& out) const {
  const double middle = (from + to) / 2, half = (to - from) / 2, h = edge.height, d = shortest_m_;
  // The singularities lie off the line. They are the zeros of the ranges, and of the distance from the line
  // between an apex and the other's image.
  const double a = 1 - edge.tilt_along * edge.tilt_along, b = -h * edge.tilt_beside * edge.tilt_along,
               rho = std::min({ellipse_through((edge.tx_at - middle) / half, edge.tx_m / half),
                               ellipse_through((edge.rx_at - middle) / half, edge.rx_m / half),
                               ellipse_through((-b / a - middle) / half, std::abs(h) * turn_ / (a * half))});
  const auto steepness = [&](double at) {
    return std::abs((at - edge.tx_at) / std::hypot(at - edge.tx_at, edge.tx_m) +
                    (at - edge.rx_at) / std::hypot(at - edge.rx_at, edge.rx_m));
  };
  const int count =
      nodes_within(rho, growth_per_m * half * std::max(steepness(from), steepness(to)), log_error);
  if (count > most_gauss_nodes && halvings < most_panel_halvings) {
    add_nodes(edge, from, middle, growth_per_m, log_error, halvings + 1, out);
    add_nodes(edge, middle, to, growth_per_m, log_error, halvings + 1, out);
    return;
  }
  const GaussRule& rule = gauss_rule(std::min(count, most_gauss_nodes));
  const double all = -half * turn_ * h / (8 * pi * d);
  for (std::size_t k = 0; k < rule.node.size(); ++k) {
    const double at = middle + half * rule.node[k], away_tx = at - edge.tx_at, away_rx = at - edge.rx_at,
                 tilted = h * edge.tilt_beside + at * edge.tilt_along,
                 square = h * h + at * at - tilted * tilted,
                 r = std::sqrt(away_tx * away_tx + edge.tx_m * edge.tx_m),
                 s = std::sqrt(away_rx * away_rx + edge.rx_m * edge.rx_m),
                 across = (d - (r - s)) * (d + (r - s));
    out.push_back({r + s, all * rule.weight[k] * across / (square * r * s), at});
  }
}

}  // namespace tubefoot
