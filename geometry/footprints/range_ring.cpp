// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/footprints/range_ring.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat2x2.hpp>
#include <numbers>

// Approximates circles and curves of equal half path length on a facet by polygons of `ring_sides` sides. The
// half path length (|x - tx| + |x - rx|) / 2 is convex. Newton's method finds its minimum, and bisection
// finds the curve along directions from an inner point (docs/notes/coverage.md).

namespace tubefoot {
namespace {

/// Computes half path lengths to points of the first image's plane, with first and second derivatives.
class HalfPath {
 public:
  HalfPath(const std::array<glm::dvec3, 3>& tx, const std::array<glm::dvec3, 3>& rx)
      : tx_(tx[0]), rx_(rx[0]) {
    const glm::dvec3 along = tx[1] - tx[0], across = tx[2] - tx[0], n = glm::cross(along, across);
    const double area2 = glm::dot(n, n);
    u = glm::normalize(along);
    v = glm::normalize(glm::cross(n, along));
    const auto on_rx = [&](glm::dvec3 way) {
      return (rx[1] - rx[0]) * (glm::dot(way, glm::cross(across, n)) / area2) +
             (rx[2] - rx[0]) * (glm::dot(way, glm::cross(n, along)) / area2);
    };
    rx_u_ = on_rx(u);
    rx_v_ = on_rx(v);
  }

  glm::dvec3 u, v;  ///< orthonormal directions in the first image's plane

  struct Value {
    double value = 0;
    glm::dvec2 slope{0};
    glm::dmat2 bend{0};
  };
  Value at(glm::dvec2 q) const {
    Value sum;
    add(tx_ + q.x * u + q.y * v, u, v, sum);
    add(rx_ + q.x * rx_u_ + q.y * rx_v_, rx_u_, rx_v_, sum);
    return sum;
  }
  glm::dvec2 foot() const { return {-glm::dot(tx_, u), -glm::dot(tx_, v)}; }

  /// Returns the point of least half path length, by damped Newton steps on a convex function.
  glm::dvec2 lowest() const {
    glm::dvec2 q = foot();
    Value here = at(q);
    for (int k = 0; k < 100; ++k) {
      const double det = here.bend[0][0] * here.bend[1][1] - here.bend[0][1] * here.bend[1][0];
      if (!(det > 0)) break;
      glm::dvec2 step{-(here.bend[1][1] * here.slope.x - here.bend[0][1] * here.slope.y) / det,
                      -(here.bend[0][0] * here.slope.y - here.bend[0][1] * here.slope.x) / det};
      Value next = at(q + step);
      while (!(next.value <= here.value) && glm::length(step) > 1e-3) {
        step *= 0.5;
        next = at(q + step);
      }
      if (!(next.value <= here.value)) break;
      q += step;
      const bool done = glm::length(step) <= 1e-9 * here.value;
      here = next;
      if (done) break;
    }
    return q;
  }

  /// Returns the distance from `from` in the direction `way` at which the half path length is `value`. It
  /// must be less at `from`.
  double reach(glm::dvec2 from, glm::dvec2 way, double value) const {
    double lo = 0, hi = value;
    while (at(from + hi * way).value < value) {
      lo = hi;
      hi *= 2;
    }
    for (int k = 0; k < 200 && hi - lo > 1e-15 * hi; ++k) {
      const double middle = lo + (hi - lo) / 2;
      (at(from + middle * way).value < value ? lo : hi) = middle;
    }
    return lo;
  }

 private:
  static void add(glm::dvec3 place, glm::dvec3 along, glm::dvec3 across, Value& sum) {
    const double r = glm::length(place);
    if (!(r > 0)) return;
    const glm::dvec2 slope{glm::dot(place, along) / r, glm::dot(place, across) / r};
    sum.value += r / 2;
    sum.slope += slope * 0.5;
    const double aa = glm::dot(along, along), ac = glm::dot(along, across), cc = glm::dot(across, across);
    sum.bend[0][0] += (aa - slope.x * slope.x) / r / 2;
    sum.bend[0][1] += (ac - slope.x * slope.y) / r / 2;
    sum.bend[1][0] += (ac - slope.x * slope.y) / r / 2;
    sum.bend[1][1] += (cc - slope.y * slope.y) / r / 2;
  }

  glm::dvec3 tx_, rx_, rx_u_{0}, rx_v_{0};
};

/// Returns points of the curve in the directions of the corners of a regular polygon under a linear map.
std::vector<glm::dvec2> round(const HalfPath& path, glm::dvec2 middle, const glm::dmat2& frame,
                              double value) {
  std::vector<glm::dvec2> points;
  for (int k = 0; k < ring_sides; ++k) {
    const double angle = 2 * std::numbers::pi * k / ring_sides;
    const glm::dvec2 way = glm::normalize(frame * glm::dvec2(std::cos(angle), std::sin(angle)));
    points.push_back(middle + path.reach(middle, way, value) * way);
  }
  return points;
}

}  // namespace

std::vector<glm::dvec3> range_ring(glm::dvec3 corner, glm::dvec3 normal, glm::dvec3 first, double range,
                                   RingSide side, double least) {
  const double along = glm::dot(normal, corner), radius2 = range * range - along * along;
  if (!(radius2 > least * least)) return {};
  const double radius = side == RingSide::inscribed
                            ? std::sqrt(radius2)
                            : std::sqrt(radius2) / std::cos(std::numbers::pi / ring_sides);
  const glm::dvec3 second = glm::cross(normal, first), foot = normal * along - corner;
  std::vector<glm::dvec3> ring;
  for (int k = 0; k < ring_sides; ++k) {
    const double angle = 2 * std::numbers::pi * k / ring_sides;
    ring.push_back(foot + radius * (std::cos(angle) * first + std::sin(angle) * second));
  }
  return ring;
}

std::vector<glm::dvec3> half_path_ring(const std::array<glm::dvec3, 3>& tx,
                                       const std::array<glm::dvec3, 3>& rx, double half_path, RingSide side,
                                       double least) {
  const HalfPath path(tx, rx);
  const glm::dvec2 lowest = path.lowest();
  if (!(path.at(lowest).value < half_path)) return {};
  std::vector<glm::dvec2> points = round(path, lowest, glm::dmat2(1), half_path);
  // The second pass adapts the directions to the shape of the curve. The corners of a long curve then lie
  // where its curvature is large.
  glm::dvec2 middle{0};
  for (const glm::dvec2& p : points) middle += p / double(ring_sides);
  double xx = 0, xy = 0, yy = 0, nearest = half_path;
  for (const glm::dvec2& p : points) {
    const glm::dvec2 d = p - middle;
    xx += d.x * d.x;
    xy += d.x * d.y;
    yy += d.y * d.y;
    nearest = std::min(nearest, glm::distance(p, lowest));
  }
  if (!(nearest > least) || !(xx > 0)) return {};
  const double l = std::sqrt(xx), across = std::sqrt(std::max(yy - xy * xy / xx, 1e-12 * xx));
  points = round(path, middle, glm::dmat2(glm::dvec2(l, xy / l), glm::dvec2(0, across)), half_path);
  if (side == RingSide::circumscribed) {
    // The intersections of the tangents at neighbouring points.
    std::vector<glm::dvec2> outside;
    for (std::size_t k = 0; k < points.size(); ++k) {
      const glm::dvec2 p = points[k], q = points[(k + 1) % points.size()];
      const glm::dvec2 m = path.at(p).slope, n = path.at(q).slope;
      const double turn = m.x * n.y - m.y * n.x, a = glm::dot(m, p), b = glm::dot(n, q);
      outside.emplace_back((a * n.y - b * m.y) / turn, (m.x * b - n.x * a) / turn);
    }
    points = std::move(outside);
  }
  std::vector<glm::dvec3> ring;
  for (const glm::dvec2& p : points) ring.push_back(p.x * path.u + p.y * path.v);
  return ring;
}

}  // namespace tubefoot
