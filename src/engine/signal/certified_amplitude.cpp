// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/signal/certified_amplitude.hpp"

#include <algorithm>
#include <limits>

#include "engine/signal/certified_factor.hpp"
#include "geometry/integrals/certified_waves.hpp"

namespace tubefoot {
namespace {

using Point = CertifiedPolygon::Point;

Ball hull_in_doubles(const Ball& a, const Ball& b) {
  return Ball::between(std::min(a.lo(), b.lo()), std::max(a.hi(), b.hi()));
}

/// Fraction of an edge at which the edge is nearest to the origin.
Ball nearest_part(const Point& a, const Point& step) {
  const Ball t = -(a.x * step.x + a.y * step.y) / (squared(step.x) + squared(step.y));
  if (!t.is_finite()) return Ball::between(0, 1);
  if (t.hi() <= 0) return 0.0;
  if (t.lo() >= 1) return 1.0;
  if (t.lo() >= 0 && t.hi() <= 1) return t;
  return Ball::between(std::clamp(t.lo(), 0.0, 1.0), std::clamp(t.hi(), 0.0, 1.0));
}

}  // namespace

Ball certified_mean_sine(std::span<const Point> points, const Ball& height, const ApexOverPlane& rx) {
  const Ball share = height / (height + rx.height), c_x = rx.x * share, c_y = rx.y * share;
  const auto sine_at = [&](const Point& about) {  // relative to the place of shortest path
    const auto sine = [&](const Ball& h, const Ball& x, const Ball& y) {
      return h / root(squared(h) + squared(about.x + x) + squared(about.y + y));
    };
    return (sine(height, c_x, c_y) + sine(rx.height, c_x - rx.x, c_y - rx.y)) / Ball(2.0);
  };
  // The nearest point of the polygon is the place of shortest path itself or lies on an edge. All points
  // that may be nearest are candidates.
  struct Candidate {
    Point at;
    Ball distance2;
  };
  std::vector<Candidate> candidates;
  bool surely_inside = true, surely_outside = false;
  Ball twice_area(0.0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Point &p = points[i], &q = points[i + 1 == points.size() ? 0 : i + 1];
    twice_area += p.x * q.y - p.y * q.x;
  }
  const bool clockwise = twice_area.middle() < 0;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Point &p = points[i], &q = points[i + 1 == points.size() ? 0 : i + 1];
    const Point from{p.x - c_x, p.y - c_y}, step{q.x - p.x, q.y - p.y};
    Ball left = from.x * step.y - from.y * step.x;  // positive on the inner side of the edge
    if (clockwise) left = -left;
    surely_inside = surely_inside && left.surely_positive();
    surely_outside = surely_outside || left.surely_negative();
    const Ball t = nearest_part(from, step);
    Candidate candidate{{from.x + t * step.x, from.y + t * step.y}, 0.0};
    candidate.distance2 = squared(candidate.at.x) + squared(candidate.at.y);
    nearest = std::min(nearest, candidate.distance2.hi());
    candidates.push_back(std::move(candidate));
  }
  const Point itself{0.0, 0.0};
  if (surely_inside || candidates.empty()) return sine_at(itself);
  std::optional<Ball> sine;
  if (!surely_outside) sine = sine_at(itself);
  for (const Candidate& candidate : candidates) {
    if (candidate.distance2.lo() > nearest) continue;
    const Ball there = sine_at(candidate.at);
    sine = sine ? hull_in_doubles(*sine, there) : there;
  }
  return *sine;
}

std::optional<ComplexBall> certified_amplitude(std::span<const Point> points, const Ball& height,
                                               const ApexOverPlane& rx, const SmoothSurface& surface,
                                               const Ball& wave_number, double tolerance) {
  std::optional<ComplexBall> edges = certified_edge_form(points, height, rx, wave_number, tolerance);
  if (!edges) return edges;
  const bool same = !surface.fluid && surface.roughness_m == 0;
  const Ball sine = same ? Ball(1.0) : certified_mean_sine(points, height, rx);
  return certified_factor(surface, sine, wave_number) * *edges;
}

}  // namespace tubefoot
