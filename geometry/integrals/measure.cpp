// SPDX-License-Identifier: GPL-3.0-or-later
// Measures footprints: area, solid angle at the apex, centroid, grazing angle and slant ranges. The area is
// the shoelace sum of corner offsets. The solid angle is a fan sum of the formula of Van Oosterom and
// Strackee (1983).

#include "geometry/integrals/measure.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

/// Winding number of the polygon about the foot point: 0 outside, 1 inside, either for a point on the
/// boundary.
int winding_about_foot(const PlanarPolygon& polygon) {
  int turns = 0;
  const std::size_t n = polygon.offsets.size();
  for (std::size_t i = 0; i < n; ++i) {
    const glm::dvec2 a = polygon.corner(i), b = polygon.corner(i + 1 == n ? 0 : i + 1);
    if (a.y <= 0 && b.y > 0 && cross(a, b) > 0) ++turns;
    if (a.y > 0 && b.y <= 0 && cross(a, b) < 0) --turns;
  }
  return turns;
}

/// Sums over the visible polygons of a footprint.
struct Total {
  double area = 0, solid_angle = 0;
  double nearest = std::numeric_limits<double>::infinity(), farthest = 0;
  double weight = 0;
  glm::dvec3 weighted_centroid{0}, first_corner{0};
};

void measure_one(const FootprintSet& set, Footprint& footprint, PlanarPolygon& polygon) {
  const FacetPlane plane{footprint.plane_normal, footprint.plane_distance_m};
  const PlaneFrame frame(plane);
  Total total;
  for (std::uint32_t p = 0; p < footprint.piece_count; ++p) {
    const Piece piece = set.pieces[footprint.first_piece + p];
    if (piece.count == 0) continue;
    polygon.assign(std::span(set.corners_m).subspan(piece.first, piece.count), plane, frame);
    const double piece_area = area(polygon);
    total.area += piece_area;
    total.solid_angle += solid_angle(polygon);
    const NearestPoint nearest = nearest_point(polygon);
    total.farthest = std::max(total.farthest, farthest_range(polygon));
    if (total.nearest == std::numeric_limits<double>::infinity())
      total.first_corner = set.corners_m[piece.first];
    total.nearest = std::min(total.nearest, nearest.range);
    const double weight = std::max(piece_area, 0.0);
    const glm::dvec2 c = centroid_offset(polygon);
    total.weight += weight;
    // The sum is relative to the footprint's first corner, so that a small footprint far away keeps its
    // digits.
    total.weighted_centroid +=
        weight * (set.corners_m[piece.first] - total.first_corner + c.x * frame.u + c.y * frame.v);
  }
  if (total.nearest == std::numeric_limits<double>::infinity()) return;

  footprint.area_m2 = total.area;
  footprint.solid_angle_sr = total.solid_angle;
  footprint.centroid_m = total.first_corner;
  if (total.weight > 0) footprint.centroid_m += total.weighted_centroid / total.weight;
  footprint.grazing_angle_rad =
      std::atan2(footprint.plane_distance_m, glm::length(frame.project(footprint.centroid_m)));
  footprint.slant_range_min_m = std::min(total.nearest, total.farthest);
  footprint.slant_range_max_m = total.farthest;
}

}  // namespace

PlaneFrame::PlaneFrame(const FacetPlane& plane) {
  const glm::dvec3& n = plane.normal;
  // The axis least aligned with the normal, so that the cross product is far from zero.
  const double x = std::abs(n.x), y = std::abs(n.y), z = std::abs(n.z);
  const glm::dvec3 axis = x <= y && x <= z   ? glm::dvec3(1, 0, 0)
                          : y <= x && y <= z ? glm::dvec3(0, 1, 0)
                                             : glm::dvec3(0, 0, 1);
  u = glm::normalize(glm::cross(n, axis));
  v = glm::cross(u, n);
}

glm::dvec2 PlaneFrame::project(glm::dvec3 p) const { return {glm::dot(p, u), glm::dot(p, v)}; }

void PlanarPolygon::assign(std::span<const glm::dvec3> corners_m, const FacetPlane& plane,
                           const PlaneFrame& frame) {
  distance = plane.distance_m;
  first = corners_m.empty() ? glm::dvec2(0) : frame.project(corners_m[0]);
  offsets.clear();
  for (const glm::dvec3& corner : corners_m) offsets.push_back(frame.project(corner - corners_m[0]));
}

double area(const PlanarPolygon& polygon) {
  double twice = 0;
  for (std::size_t i = 2; i < polygon.offsets.size(); ++i)
    twice += cross(polygon.offsets[i - 1], polygon.offsets[i]);
  return twice / 2;
}

glm::dvec2 centroid_offset(const PlanarPolygon& polygon) {
  const auto& d = polygon.offsets;
  double weight = 0;
  glm::dvec2 sum{0}, mean{0};
  for (std::size_t i = 2; i < d.size(); ++i) {
    const double triangle = std::max(cross(d[i - 1], d[i]), 0.0);
    weight += triangle;
    sum += triangle * (d[i - 1] + d[i]) / 3.0;
  }
  if (weight > 0) return sum / weight;
  for (const glm::dvec2& corner : d) mean += corner;
  return d.empty() ? mean : mean / double(d.size());
}

double solid_angle(const PlanarPolygon& polygon) {
  const auto& d = polygon.offsets;
  if (d.size() < 3) return 0;
  const auto range = [&](glm::dvec2 q) { return std::hypot(q.x, q.y, polygon.distance); };
  const double d2 = polygon.distance * polygon.distance;
  const glm::dvec2 a = polygon.corner(0);
  const double ra = range(a);
  glm::dvec2 b = polygon.corner(1);
  double rb = range(b), sum = 0;
  for (std::size_t i = 2; i < d.size(); ++i) {
    const glm::dvec2 c = polygon.corner(i);
    const double rc = range(c);
    const double triple = polygon.distance * cross(d[i - 1], d[i]);
    const double ab = d2 + glm::dot(a, b), bc = d2 + glm::dot(b, c), ca = d2 + glm::dot(c, a);
    sum += 2 * std::atan2(triple, ra * rb * rc + ab * rc + bc * ra + ca * rb);
    b = c;
    rb = rc;
  }
  return sum;
}

NearestPoint nearest_point(const PlanarPolygon& polygon) {
  if (winding_about_foot(polygon) != 0) return {-polygon.first, polygon.distance};
  const std::size_t n = polygon.offsets.size();
  NearestPoint nearest;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < n; ++i) {
    const glm::dvec2 from = polygon.offsets[i], edge = polygon.offsets[i + 1 == n ? 0 : i + 1] - from;
    const double length2 = glm::dot(edge, edge);
    const double along =
        length2 > 0 ? std::clamp(-glm::dot(polygon.first + from, edge) / length2, 0.0, 1.0) : 0.0;
    const glm::dvec2 offset = from + along * edge;
    const glm::dvec2 q = polygon.first + offset;
    if (glm::dot(q, q) < least) {
      least = glm::dot(q, q);
      nearest.offset = offset;
    }
  }
  nearest.range = std::sqrt(polygon.distance * polygon.distance + least);
  return nearest;
}

double farthest_range(const PlanarPolygon& polygon) {
  double farthest2 = 0;
  for (std::size_t i = 0; i < polygon.offsets.size(); ++i)
    farthest2 = std::max(farthest2, glm::dot(polygon.corner(i), polygon.corner(i)));
  return std::sqrt(polygon.distance * polygon.distance + farthest2);
}

void measure(FootprintSet& set) {
  PlanarPolygon polygon;
  for (Footprint& footprint : set.footprints) measure_one(set, footprint, polygon);
}

}  // namespace tubefoot
