// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/chart.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "geometry/visibility/exact_direction.hpp"

namespace tubefoot::atlas {
namespace {

using Rational = CGAL::Exact_rational;

/// Returns whether a piece covers a point. Pieces are clockwise in (u, v). A piece whose rounded corners
/// coincide covers nothing.
bool covers(const std::vector<glm::dvec2>& corners, glm::dvec2 p) {
  bool inside = false;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const glm::dvec2 a = corners[k] - p, b = corners[k + 1 == corners.size() ? 0 : k + 1] - p;
    const double turn = a.x * b.y - a.y * b.x;
    if (turn > 0) return false;
    inside = inside || turn < 0;
  }
  return inside;
}

}  // namespace

Chart::Chart(const TubeSet& tubes, std::uint32_t tube) {
  std::array<GridPoint, 4> ray;
  for (int k = 0; k < 4; ++k) ray[k] = tubes.rays.at(tubes.tubes.at(tube)[k]);
  frame_ = {ray[0], ray[3] - ray[0], ray[1] - ray[0]};
  if (ray[2] - ray[3] != frame_[2]) throw std::invalid_argument("a tube that is no parallelogram");
  for (int k = 0; k < 3; ++k) dual_[k] = cross(exact(frame_[(k + 1) % 3]), exact(frame_[(k + 2) % 3]));
  if (dot(dual_[0], exact(frame_[0])) < 0)
    for (ExactVector& d : dual_)
      for (Rational& x : d) x = -x;
}

glm::dvec3 Chart::direction(glm::dvec2 uv) const {
  const auto vector = [](GridPoint p) { return glm::dvec3(p.x, p.y, p.z); };
  return vector(frame_[0]) + uv.x * vector(frame_[1]) + uv.y * vector(frame_[2]);
}

bool Chart::polygon(const NameContext& context, const TubeVisibility& seen, const NamedPiece& piece,
                    Polygon& result) const {
  result.facet = piece.facet;
  result.corners.clear();
  std::vector<std::array<Rational, 2>> p;
  for (const ExactVector& d : exact_directions(context, seen.corners, piece)) {
    const Rational w = dot(dual_[0], d);
    if (w <= 0) return false;
    p.push_back({Rational(dot(dual_[1], d) / w), Rational(dot(dual_[2], d) / w)});
    result.corners.emplace_back(p.back()[0].convert_to<double>(), p.back()[1].convert_to<double>());
  }
  Rational twice = 0;
  for (std::size_t k = 2; k < p.size(); ++k)
    twice += (p[k][0] - p[0][0]) * (p[k - 1][1] - p[0][1]) - (p[k - 1][0] - p[0][0]) * (p[k][1] - p[0][1]);
  result.area = twice / 2;
  return true;
}

std::vector<FacetId> locate(std::span<const Chart::Polygon> polygons, std::span<const glm::dvec2> points,
                            std::uint32_t n) {
  std::vector<FacetId> facet(points.size(), nothing_there);
  const auto cell = [n](double x) {
    return static_cast<std::uint32_t>(std::clamp(std::floor(x * n), 0.0, double(n - 1)));
  };
  for (const Chart::Polygon& polygon : polygons) {
    glm::dvec2 lo(1), hi(0);
    for (const glm::dvec2 c : polygon.corners) {
      lo = {std::min(lo.x, c.x), std::min(lo.y, c.y)};
      hi = {std::max(hi.x, c.x), std::max(hi.y, c.y)};
    }
    for (std::uint32_t j = cell(lo.y); j <= cell(hi.y); ++j)
      for (std::uint32_t i = cell(lo.x); i <= cell(hi.x); ++i) {
        const std::size_t k = std::size_t(j) * n + i;
        if (facet[k] != polygon.facet && covers(polygon.corners, points[k]))
          facet[k] = facet[k] == nothing_there ? polygon.facet : several_there;
      }
  }
  return facet;
}

}  // namespace tubefoot::atlas
