// SPDX-License-Identifier: GPL-3.0-or-later
// Integrates waves F(P) of path length over a planar polygon as a sum of integrals along its edges
// (edge_form.hpp, docs/notes/smooth-surfaces.md). Near the point c of shortest path the code expands F about
// the shortest path D. Newton's form keeps the digits of [F(P) - F(D)] / (P - D).

#include "geometry/integrals/edge_form.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <utility>

#include "geometry/integrals/ellipse_rule.hpp"
#include "geometry/integrals/gauss_rules.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

/// True if the point of the plane lies in the polygon or within `margin` of it.
bool reaches(const PlanarPolygon& polygon, glm::dvec2 point, double margin) {
  const std::size_t n = polygon.offsets.size();
  bool inside = false;
  for (std::size_t k = 0; k < n; ++k) {
    const glm::dvec2 a = polygon.corner(k) - point, b = polygon.corner(k + 1 == n ? 0 : k + 1) - point;
    const glm::dvec2 edge = b - a;
    const double square = glm::dot(edge, edge);
    const double along = square > 0 ? std::clamp(-glm::dot(a, edge) / square, 0.0, 1.0) : 0.0;
    if (glm::length(a + along * edge) <= margin) return true;
    if ((a.y <= 0) != (b.y <= 0) && (cross(a, b) > 0) == (b.y > 0)) inside = !inside;
  }
  return inside;
}

/// Logarithm of the error bound for rules along an edge, 64/15 1e16.
constexpr double log_edge_error = 38.3;

/// Interpolation points of F about the shortest path, which comes first. These Chebyshev points alternate
/// between outside and inside, an order in which Newton's form is stable.
constexpr std::array<double, 11> newton_points{0,
                                               1,
                                               -1,
                                               0.58778525229247313,
                                               -0.58778525229247313,
                                               0.95105651629515357,
                                               -0.95105651629515357,
                                               0.30901699437494742,
                                               -0.30901699437494742,
                                               0.80901699437494742,
                                               -0.80901699437494742};
constexpr std::size_t quotients = newton_points.size() - 1;

}  // namespace

double arc_angle(const PlanarPolygon& polygon, double range_m) {
  const double square = (range_m - polygon.distance) * (range_m + polygon.distance);
  if (!(square > 0) || !(range_m > 0)) return 0;
  // A ray from the foot point meets the circle inside the polygon if the boundary beyond the circle winds
  // about the ray. The angle is therefore that of all boundary outside the circle.
  double angle = 0;
  const std::size_t n = polygon.offsets.size();
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t next = k + 1 == n ? 0 : k + 1;
    const glm::dvec2 a = polygon.corner(k), edge = polygon.offsets[next] - polygon.offsets[k];
    const double turn = cross(a, edge), e2 = glm::dot(edge, edge);
    const auto add = [&](double from, double to) {
      if (to <= from) return;
      const glm::dvec2 p = a + from * edge, q = a + to * edge;
      angle += std::atan2(turn * (to - from), glm::dot(p, q));
    };
    if (!(e2 > 0)) continue;
    // Solves |a + t edge|^2 = square; the solutions are t = middle +- half.
    const double middle = -glm::dot(a, edge) / e2, inner = square - turn * turn / e2;
    if (inner <= 0) {
      add(0, 1);
      continue;
    }
    const double half = std::sqrt(inner / e2);
    add(0, std::min(1.0, middle - half));
    add(std::max(0.0, middle + half), 1);
  }
  return angle;
}

/// Both apexes over the plane, relative to the point c of shortest path.
struct EdgeForm::Plane {
  double tx_height, rx_height;
  glm::dvec2 tx_foot, rx_foot;  ///< relative to c
  double shortest;              ///< D
  glm::dvec2 tilt;              ///< component in the plane of the unit vector along the line through c
  double turn;                  ///< dpsi is this times cross(place, step) over the squared distance
  bool near;                    ///< true if F(D) is subtracted, because the polygon may contain c
};
/// A directed line through `from`, relative to c.
struct EdgeForm::Edge {
  glm::dvec2 from, along;  ///< along: unit vector
  double height;           ///< cross(from, along)
};

EdgeForm::EdgeForm(Wave wave, std::size_t count, double growth_per_m)
    : wave_(std::move(wave)),
      growth_per_m_(growth_per_m),
      values_(count),
      at_shortest_(count),
      quotient_(quotients * count) {}

void EdgeForm::expand(double shortest) {
  // Within a quarter of a radian eleven points are accurate to 1e-17.
  width_ = std::min(0.25 / growth_per_m_, shortest / 2);
  wave_(shortest, at_shortest_);
  const std::size_t count = values_.size();
  for (std::size_t j = 1; j < newton_points.size(); ++j) {
    wave_(shortest + width_ * newton_points[j], values_);
    for (std::size_t i = 0; i < count; ++i) {
      std::complex<double> difference = (values_[i] - at_shortest_[i]) / newton_points[j];
      for (std::size_t m = 1; m < j; ++m)
        difference = (difference - quotient_[(m - 1) * count + i]) / (newton_points[j] - newton_points[m]);
      quotient_[(j - 1) * count + i] = difference;
    }
  }
}

void EdgeForm::add(const PlanarPolygon& polygon, const PathCutter::Receiver& rx,
                   std::span<std::complex<double>> out) {
  const double heights = polygon.distance + rx.distance;
  if (!(polygon.distance > 0) || !(rx.distance > 0) || polygon.offsets.size() < 3) return;
  const glm::dvec2 c = rx.foot * (polygon.distance / heights);
  Plane plane{polygon.distance, rx.distance, -c, rx.foot - c, 0, {}, 0, false};
  plane.shortest = std::sqrt(heights * heights + glm::dot(rx.foot, rx.foot));
  plane.tilt = rx.foot / plane.shortest;
  plane.turn = heights / plane.shortest;
  const double nearer = std::min(polygon.distance, rx.distance) * plane.shortest / heights;
  plane.near = reaches(polygon, c, nearer / 4);
  if (plane.near) expand(plane.shortest);
  const std::size_t n = polygon.offsets.size();
  for (std::size_t k = 0; k < n; ++k) {
    const glm::dvec2 step = polygon.offsets[k + 1 == n ? 0 : k + 1] - polygon.offsets[k];
    const double length = glm::length(step);
    if (!(length > 0)) continue;
    const glm::dvec2 from = polygon.first - c + polygon.offsets[k], along = step / length;
    const Edge edge{from, along, cross(from, along)};
    if (edge.height != 0) add(plane, edge, 0, length, 0, out);
  }
}

void EdgeForm::add(const Plane& plane, const Edge& edge, double from, double to, int halvings,
                   std::span<std::complex<double>> out) {
  const double middle = (from + to) / 2, half = (to - from) / 2;
  // The singularities lie off the line. They are the zeros of the ranges, and of the distance from the line
  // through c.
  const auto ellipse_of = [&](glm::dvec2 foot, double height) {
    const glm::dvec2 away = edge.from - foot;
    const double beside = cross(away, edge.along);
    return ellipse_through((-glm::dot(away, edge.along) - middle) / half,
                           std::sqrt(beside * beside + height * height) / half);
  };
  double rho =
      std::min(ellipse_of(plane.tx_foot, plane.tx_height), ellipse_of(plane.rx_foot, plane.rx_height));
  const double slope = glm::dot(edge.along, plane.tilt), start = glm::dot(edge.from, plane.tilt);
  const double a = 1 - slope * slope, b = glm::dot(edge.from, edge.along) - start * slope,
               c = glm::dot(edge.from, edge.from) - start * start;
  if (!plane.near)
    rho = std::min(
        rho, ellipse_through((-b / a - middle) / half, std::sqrt(std::max(0.0, a * c - b * b)) / (a * half)));
  const auto steepness = [&](double at) {
    const glm::dvec2 place = edge.from + at * edge.along;
    const auto of = [&](glm::dvec2 foot, double height) {
      const glm::dvec2 away = place - foot;
      return glm::dot(away, edge.along) / std::sqrt(glm::dot(away, away) + height * height);
    };
    return std::abs(of(plane.tx_foot, plane.tx_height) + of(plane.rx_foot, plane.rx_height));
  };
  const int nodes =
      nodes_within(rho, growth_per_m_ * half * std::max(steepness(from), steepness(to)), log_edge_error);
  constexpr int most_halvings = 60;
  if (nodes > most_gauss_nodes && halvings < most_halvings) {
    add(plane, edge, from, middle, halvings + 1, out);
    add(plane, edge, middle, to, halvings + 1, out);
    return;
  }
  const GaussRule& rule = gauss_rule(std::min(nodes, most_gauss_nodes));
  for (std::size_t k = 0; k < rule.node.size(); ++k) {
    const double at = middle + half * rule.node[k];
    const glm::dvec2 place = edge.from + at * edge.along;
    const double tilted = glm::dot(place, plane.tilt), square = glm::dot(place, place) - tilted * tilted;
    const auto range = [&](glm::dvec2 foot, double height) {
      const glm::dvec2 away = place - foot;
      return std::sqrt(glm::dot(away, away) + height * height);
    };
    const double r = range(plane.tx_foot, plane.tx_height), s = range(plane.rx_foot, plane.rx_height);
    const double d = plane.shortest;
    const double angle = rule.weight[k] * half * plane.turn * edge.height / (4 * std::numbers::pi);
    // (P - D) (P + D) = 4 D^2 square / across. This form needs no difference of paths.
    const double across = (d - (r - s)) * (d + (r - s)), total = r + s + d,
                 per_square = 4 * d * d / (across * total), longer = per_square * square;
    if (plane.near && longer < width_) {
      // Both terms are proportional to the squared distance from c. The code cancels that factor.
      const double x = longer / width_, rest = total * per_square / (2 * d * r * s);
      for (std::size_t i = 0; i < values_.size(); ++i) {
        std::complex<double> quotient = quotient_[(quotients - 1) * values_.size() + i];
        for (std::size_t m = quotients - 1; m > 0; --m)
          quotient = quotient * (x - newton_points[m]) + quotient_[(m - 1) * values_.size() + i];
        out[i] += angle * (rest * (at_shortest_[i] + x * quotient) - 2 / d * per_square / width_ * quotient);
      }
      continue;
    }
    if (!(square > 0)) continue;
    const double weight = across / (2 * d * r * s);
    wave_(r + s, values_);
    for (std::size_t i = 0; i < values_.size(); ++i) {
      const std::complex<double> whole = plane.near ? 2 / d * at_shortest_[i] : std::complex<double>(0);
      out[i] += angle / square * (whole - weight * values_[i]);
    }
  }
}

}  // namespace tubefoot
