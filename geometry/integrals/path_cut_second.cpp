// SPDX-License-Identifier: GPL-3.0-or-later
// The part of PathCutter for a second path: it finds the points that both receivers receive in the same
// sample. Angles at which ellipses of the two paths meet or touch rays bound the cells, in closed form where
// both paths share a transmitter.

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "geometry/integrals/path_cut.hpp"

namespace tubefoot {

/// Angles at which an ellipse of the first receiver meets one of the second. With p and f relative to the
/// transmitter's foot point and h the transmitter's height, an ellipse of path P about a receiver at foot f
/// and height d obeys
///   2 P r_t = 2 p.f + P^2 + h^2 - d^2 - |f|^2.
/// Eliminating r_t leaves a straight line.
void PathCutter::add_meetings(double first_path, double second_path, const Sector& sector,
                              std::vector<double>& angles) const {
  const auto level = [&](const Apex& apex, double path) {
    const glm::dvec2 foot = apex.foot - transmit_.foot;
    return path * path + (transmit_.height - apex.height) * (transmit_.height + apex.height) -
           glm::dot(foot, foot);
  };
  const glm::dvec2 normal =
      2.0 * (second_path * (receive_.foot - transmit_.foot) - first_path * (second_->foot - transmit_.foot));
  const double size2 = glm::dot(normal, normal);
  if (!(size2 > 0)) return;  // concentric ellipses
  const double offset = first_path * level(*second_, second_path) - second_path * level(receive_, first_path);
  const glm::dvec2 middle = transmit_.foot + normal * (offset / size2);
  const double reach = first_path + glm::length(transmit_.foot);  // the ellipse is no farther from c than
                                                                  // this
  if (!(glm::dot(middle, middle) < reach * reach)) return;
  Line chord;
  chord.along = glm::dvec2(-normal.y, normal.x) / std::sqrt(size2);
  chord.length = 4 * reach;
  chord.from = middle - 2 * reach * chord.along;
  add_crossings(chord, first_path, transmit_, receive_, sector, angles);
}

/// The same for paths without a common apex, whose ellipses have no such chord. The function searches for
/// sign changes along the first ellipse. If a difference has an extremum near 0 between two points, it also
/// searches at the extremum.
void PathCutter::add_meetings_found(double first_path, double second_path, const Sector& sector,
                                    std::vector<double>& angles) const {
  if (!(first_path > shortest_) || !(second_path > second_shortest_)) return;
  constexpr int places = 32, most_steps = 200;
  constexpr double golden = 0.38196601125010515;
  const auto further = [&](double angle) {
    const glm::dvec2 direction{sector.middle.x * std::cos(angle) - sector.middle.y * std::sin(angle),
                               sector.middle.x * std::sin(angle) + sector.middle.y * std::cos(angle)};
    const glm::dvec2 p = distance(Curve{nullptr, first_path}, direction) * direction;
    return second_transmit_.range(p) + second_->range(p) - second_path;
  };
  const auto bisect = [&](double a, double at_a, double b) {
    for (int k = 0; k < most_steps; ++k) {
      const double middle = a + (b - a) / 2;
      if (!(middle > a && middle < b)) break;
      const double at = further(middle);
      if ((at < 0) == (at_a < 0))
        a = middle;
      else
        b = middle;
    }
    angles.push_back(b);
  };
  std::array<double, places + 1> angle, value;
  for (int k = 0; k <= places; ++k) {
    angle[std::size_t(k)] = sector.half * (2.0 * k / places - 1);
    value[std::size_t(k)] = further(angle[std::size_t(k)]);
  }
  for (std::size_t k = 0; k < places; ++k) {
    if ((value[k] < 0) != (value[k + 1] < 0)) {
      bisect(angle[k], value[k], angle[k + 1]);
      continue;
    }
    if (k == 0 || (value[k - 1] < 0) != (value[k] < 0)) continue;
    const double sign = value[k] < 0 ? -1 : 1;
    if (!(sign * value[k] <= sign * value[k - 1] && sign * value[k] <= sign * value[k + 1])) continue;
    double a = angle[k - 1], b = angle[k + 1];
    for (int step = 0; step < 60; ++step) {
      const double x = a + golden * (b - a), y = b - golden * (b - a), at_x = further(x), at_y = further(y);
      const double turning = sign * at_x < sign * at_y ? x : y;
      if (std::min(sign * at_x, sign * at_y) < 0) {
        bisect(angle[k - 1], value[k - 1], turning);
        bisect(turning, -sign, angle[k + 1]);
        break;
      }
      (turning == x ? b : a) = turning == x ? y : x;
    }
  }
}

/// Angles at which a ray from c touches an ellipse of the second receiver that does not contain c. There the
/// discriminant (v.d)^2 - a c with a = 4 (P^2 - (m.d)^2) is 0, a quadratic equation in the tangent of the
/// angle.
void PathCutter::add_tangents(double path, const Sector& sector, std::vector<double>& angles) const {
  const glm::dvec2 t = -second_transmit_.foot, r = -second_->foot;
  const double rt = second_transmit_range_, rr = second_->range({0, 0});
  const double c = EllipseOnRay(path, rt, rr, 0, 0).c;
  if (!(c > 0)) return;
  const glm::dvec2 m = t - r, aside{-sector.middle.y, sector.middle.x};
  const glm::dvec2 v = 4 * path * path * t - 2 * (path * path + (rt - rr) * (rt + rr)) * m;
  const double v1 = glm::dot(v, sector.middle), v2 = glm::dot(v, aside), m1 = glm::dot(m, sector.middle),
               m2 = glm::dot(m, aside), round = 4 * c * path * path;
  const double p2 = v2 * v2 + 4 * c * m2 * m2 - round, p1 = v1 * v2 + 4 * c * m1 * m2,
               p0 = v1 * v1 + 4 * c * m1 * m1 - round;
  const double discriminant = p1 * p1 - p2 * p0;
  if (!(discriminant >= 0)) return;
  const double q = -(p1 + std::copysign(std::sqrt(discriminant), p1));
  for (const double tangent : {q / p2, p0 / q})
    if (const double angle = std::atan(tangent); std::abs(angle) < sector.half) angles.push_back(angle);
}

/// The stretch of a ray from c inside an ellipse of the second receiver.
std::optional<PathCutter::Stretch> PathCutter::in_second(double path, glm::dvec2 direction) const {
  // The distance between the apexes may exceed the path. The equation is then that of a hyperbola.
  if (!(path > second_shortest_)) return std::nullopt;
  const EllipseOnRay on(path, second_transmit_range_, second_->range({0, 0}),
                        -glm::dot(second_transmit_.foot, direction), -glm::dot(second_->foot, direction));
  if (!(on.a > 0)) return std::nullopt;
  const double root = std::sqrt(std::max(on.discriminant(), 0.0));
  if (on.c < 0) return Stretch{0, on.b > 0 ? -on.c / (on.b + root) : (root - on.b) / on.a};
  if (on.b >= 0 || on.discriminant() < 0) return std::nullopt;
  return Stretch{on.c / (root - on.b), (root - on.b) / on.a};
}

/// Integrates the part of a cell that the second receiver receives in the same sample.
void PathCutter::integrate_both(const Curve& near, const Curve& far, double from, double to, const Cell& cell,
                                std::span<double> out) {
  const std::optional<Stretch> outer = in_second(to, cell.middle), inner = in_second(from, cell.middle);
  if (!outer) return;
  const Curve begin{nullptr, to, true, true}, end{nullptr, to, true, false};
  const auto take = [&](const Curve& a, double a_at, const Curve& b, double b_at) {
    integrate_whole(distance(near, cell.middle) < a_at ? a : near,
                    distance(far, cell.middle) > b_at ? b : far, cell, out);
  };
  if (!inner) return take(begin, outer->enter, end, outer->leave);
  if (inner->enter > 0) take(begin, outer->enter, Curve{nullptr, from, true, true}, inner->enter);
  take(Curve{nullptr, from, true, false}, inner->leave, end, outer->leave);
}

}  // namespace tubefoot
