// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/visibility/gnomonic_frame.hpp"

// Projects facets to the gnomonic plane of a tube and compares their positions there. All tests are made in
// double with error bounds, and return "unknown" when rounding could change the result.

namespace tubefoot {
namespace {

/// Returns the side of p relative to the line from a to b, with coordinates known to `slack`: +1 left, -1
/// right, 0 unknown.
int side_of_line(glm::dvec2 a, glm::dvec2 b, glm::dvec2 p, double slack) {
  const double ux = b.x - a.x, uy = b.y - a.y, vx = p.x - a.x, vy = p.y - a.y;
  const double cross = ux * vy - uy * vx;
  const double bound = 8 * slack * (std::abs(ux) + std::abs(uy) + std::abs(vx) + std::abs(vy) + slack);
  return cross > bound ? 1 : cross < -bound ? -1 : 0;
}

double slack_of(double largest_coordinate) { return GnomonicFrame::margin * (1 + largest_coordinate); }

/// Returns true only if all of `b` lies on the far side of an edge of `a`. The bounds of both must meet.
/// `extent` is that of both together, so that no corner of one is farther from a corner of the other.
bool edge_parts(const FramedFacet& a, const FramedFacet& b, double slack, double extent) {
  if (a.turn == 0) return false;
  const auto shared = [&](VertexId v) {
    return static_cast<unsigned>(v == a.cone.vertex[0]) | static_cast<unsigned>(v == a.cone.vertex[1]) << 1 |
           static_cast<unsigned>(v == a.cone.vertex[2]) << 2;
  };
  const unsigned same0 = shared(b.cone.vertex[0]), same1 = shared(b.cone.vertex[1]),
                 same2 = shared(b.cone.vertex[2]);
  const glm::dvec2 p = b.corner[0], q = b.corner[1], r = b.corner[2];
  // The bound is that of side_of_line, where a corner's distance from the edge's start is at most the extent.
  // The line's constant includes the rounding of products with the coordinates; slack is a large multiple of
  // it.
  const auto parts = [&](const glm::dvec3& line, unsigned ends) {
    const double bound = 8 * slack * (std::abs(line.x) + std::abs(line.y) + extent + slack);
    const auto beyond = [&](glm::dvec2 corner, unsigned same) {
      return (line.x * corner.x + line.y * corner.y - line.z < -bound) | ((same & ends) != 0);
    };
    return (beyond(p, same0) & beyond(q, same1) & beyond(r, same2)) != 0;
  };
  return parts(a.line[0], 0b011) || parts(a.line[1], 0b110) || parts(a.line[2], 0b101);
}

}  // namespace

GnomonicFrame::GnomonicFrame(const std::array<GridPoint, 4>& rays) {
  glm::dvec3 sum{0};
  for (const GridPoint& ray : rays) sum += glm::normalize(as_double(ray));
  axis_ = glm::normalize(sum);
  right_ = glm::normalize(as_double(rays[1]) - as_double(rays[0]));
  // In a narrow tube whose rays differ in length, the difference of two rays is nearly parallel to the axis.
  // A second subtraction removes the rounding error of the first one.
  for (int pass = 0; pass < 2; ++pass) right_ = glm::normalize(right_ - axis_ * glm::dot(right_, axis_));
  up_ = glm::cross(axis_, right_);
  tube_ = Bounds::nothing();
  for (int k = 0; k < 4; ++k) {
    const glm::dvec3 ray = as_double(rays[k]);
    if (!project(ray, glm::length(ray), corner_[k])) {
      tube_ = Bounds::everything();
      return;
    }
    tube_.add(corner_[k]);
  }
}

bool GnomonicFrame::surely_inside(glm::dvec2 p) const {
  if (!tube_.is_finite()) return false;
  const double slack =
      slack_of(std::max({std::abs(tube_.x0), std::abs(tube_.x1), std::abs(tube_.y0), std::abs(tube_.y1)}));
  const int first = side_of_line(corner_[0], corner_[1], p, slack);
  if (first == 0) return false;
  for (int k = 1; k < 4; ++k)
    if (side_of_line(corner_[k], corner_[(k + 1) % 4], p, slack) != first) return false;
  return true;
}

void RangedFacet::measure_ranges() {
  double low = std::numeric_limits<double>::infinity(), high = 0, longest = 0;
  for (int k = 0; k < 3; ++k) {
    const glm::dvec3 d = as_double(cone.point[k]), edge = as_double(cone.point[(k + 1) % 3]) - d;
    const double square = glm::dot(d, d);
    range[k] = std::sqrt(square);
    low = std::min(low, square);
    high = std::max(high, square);
    longest = std::max(longest, glm::dot(edge, edge));
  }
  // A point of a triangle is at most longest side / sqrt(3) from a vertex, and is not nearer than the
  // triangle's plane.
  const glm::dvec3 normal(cone.normal.x, cone.normal.y, cone.normal.z);
  const double plane = static_cast<double>(cone.offset) / std::sqrt(glm::dot(normal, normal));
  nearest = std::max(std::sqrt(low) - 0.57736 * std::sqrt(longest), plane) * (1 - 1e-12);
  farthest = std::sqrt(high) * (1 + 1e-12);
}

void FramedFacet::place(const GnomonicFrame& frame) {
  bounds = Bounds::nothing();
  bool finite = true;
  for (int k = 0; k < 3; ++k) {
    finite = finite && frame.project(as_double(cone.point[k]), range[k], corner[k]);
    if (finite) bounds.add(corner[k]);
  }
  placed = finite;
  if (finite) {
    slack = slack_of(
        std::max({std::abs(bounds.x0), std::abs(bounds.x1), std::abs(bounds.y0), std::abs(bounds.y1)}));
    bounds.widen(slack);
    turn = side_of_line(corner[0], corner[1], corner[2], slack);
    for (int k = 0; k < 3; ++k) {
      const glm::dvec2 a = corner[k], along = static_cast<double>(turn) * (corner[(k + 1) % 3] - a);
      line[k] = {-along.y, along.x, along.x * a.y - along.y * a.x};
    }
  } else {
    bounds = Bounds::everything();
    turn = 0;
  }
}

int where(const FramedFacet& facet, glm::dvec2 p) {
  if (p.x < facet.bounds.x0 || p.x > facet.bounds.x1 || p.y < facet.bounds.y0 || p.y > facet.bounds.y1)
    return -1;
  if (facet.turn == 0) return 0;
  bool inside = true;
  for (int k = 0; k < 3; ++k) {
    const int s = side_of_line(facet.corner[k], facet.corner[(k + 1) % 3], p, facet.slack);
    if (s == -facet.turn) return -1;
    inside = inside && s != 0;
  }
  return inside ? 1 : 0;
}

bool surely_apart(const FramedFacet& a, const FramedFacet& b) {
  if (!a.placed || !b.placed) return false;
  const double slack = std::max(a.slack, b.slack);
  const double extent = (a.bounds.x1 - a.bounds.x0) + (a.bounds.y1 - a.bounds.y0) +
                        (b.bounds.x1 - b.bounds.x0) + (b.bounds.y1 - b.bounds.y0);
  return edge_parts(a, b, slack, extent) || edge_parts(b, a, slack, extent);
}

bool surely_covers(const FramedFacet& outer, const FramedFacet& inner) {
  if (!outer.placed || !inner.placed || outer.turn == 0) return false;
  const double slack = std::max(outer.slack, inner.slack);
  for (int v = 0; v < 3; ++v) {
    const VertexId id = inner.cone.vertex[v];
    if (std::ranges::find(outer.cone.vertex, id) != outer.cone.vertex.end()) continue;
    for (int k = 0; k < 3; ++k)
      if (side_of_line(outer.corner[k], outer.corner[(k + 1) % 3], inner.corner[v], slack) != outer.turn)
        return false;
  }
  return true;
}

}  // namespace tubefoot
