// SPDX-License-Identifier: GPL-3.0-or-later

// Computes the union of convex pieces of a facet as an OGC simple feature in plan view. A shape has plan
// area if its area exceeds 10 nm times its perimeter. GEOS repairs shapes that rounding made invalid.

#include "footprints/plan_shape.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <limits>
#include <numeric>

#include "files/gdal_messages.hpp"
#include "geometry/footprints/piece_union.hpp"

namespace tubefoot {
namespace {

std::vector<std::uint32_t> ring_of(const Piece& piece) {
  std::vector<std::uint32_t> ring(piece.count);
  std::iota(ring.begin(), ring.end(), piece.first);
  return ring;
}

/// Returns each piece as a polygon of its own, for pieces whose union cannot be formed.
std::vector<RingedPolygon> apart(std::span<const Piece> pieces) {
  std::vector<RingedPolygon> polygons;
  for (const Piece& piece : pieces) polygons.push_back({ring_of(piece)});
  return polygons;
}

bool has_plan_area(std::span<const glm::dvec3> corners_m, const RingedPolygon& polygon) {
  constexpr double thinnest_m = 1e-8;
  double area = 0, length = 0;
  for (const std::vector<std::uint32_t>& ring : polygon) {
    const glm::dvec2 origin(corners_m[ring[0]]);
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const glm::dvec2 a = glm::dvec2(corners_m[ring[k]]) - origin,
                       b = glm::dvec2(corners_m[ring[(k + 1) % ring.size()]]) - origin;
      area += (a.x * b.y - a.y * b.x) / 2;
      length += glm::distance(a, b);
    }
  }
  return std::abs(area) > thinnest_m * length;
}

PlanShape::Line closed_line(std::span<const glm::dvec3> on_map, const std::vector<std::uint32_t>& ring) {
  PlanShape::Line line;
  for (std::size_t k = 0; k <= ring.size(); ++k) line.push_back(on_map[ring[k % ring.size()]]);
  return line;
}

template <class Curve>
void add_points(Curve& curve, const PlanShape::Line& line) {
  for (const glm::dvec3& p : line) curve.addPoint(p.x, p.y, p.z);
}

PlanShape::Line points_of(const OGRLinearRing& ring) {
  PlanShape::Line line;
  for (int k = 0; k < ring.getNumPoints(); ++k) line.emplace_back(ring.getX(k), ring.getY(k), ring.getZ(k));
  return line;
}

void collect(const OGRGeometry& from, std::vector<std::vector<PlanShape::Line>>& polygons) {
  if (const auto* many = dynamic_cast<const OGRGeometryCollection*>(&from)) {
    for (const OGRGeometry* one : *many) collect(*one, polygons);
  } else if (const auto* polygon = dynamic_cast<const OGRPolygon*>(&from); polygon && !polygon->IsEmpty()) {
    polygons.emplace_back();
    for (const OGRLinearRing* ring : *polygon) polygons.back().push_back(points_of(*ring));
  }
}

/// Returns GEOS' repair of an invalid feature. Crossings that GEOS adds lie on an edge. A crossing without
/// a height gets the height of the nearest corner.
std::vector<std::vector<PlanShape::Line>> mended(const OGRMultiPolygon& broken, const PlanShape& shape) {
  std::vector<std::vector<PlanShape::Line>> polygons;
  const std::unique_ptr<OGRGeometry> made(broken.MakeValid());
  if (!made) return polygons;
  collect(*made, polygons);
  for (auto& polygon : polygons)
    for (PlanShape::Line& line : polygon)
      for (glm::dvec3& p : line) {
        if (std::isfinite(p.z)) continue;
        double least = std::numeric_limits<double>::infinity();
        for (const auto& own : shape.polygons)
          for (const PlanShape::Line& ring : own)
            for (const glm::dvec3& q : ring)
              if (const double away = std::hypot(p.x - q.x, p.y - q.y); away < least) {
                least = away;
                p.z = q.z;
              }
      }
  return polygons;
}

}  // namespace

std::unique_ptr<OGRMultiPolygon> PlanShape::multi_polygon() const {
  auto shape = std::make_unique<OGRMultiPolygon>();
  shape->set3D(TRUE);
  for (const std::vector<Line>& rings : polygons) {
    auto* polygon = new OGRPolygon;  // owned by the shape
    for (const Line& line : rings) {
      auto* ring = new OGRLinearRing;  // owned by the polygon
      add_points(*ring, line);
      polygon->addRingDirectly(ring);
    }
    shape->addGeometryDirectly(polygon);
  }
  return shape;
}

std::unique_ptr<OGRMultiLineString> PlanShape::multi_line() const {
  auto shape = std::make_unique<OGRMultiLineString>();
  shape->set3D(TRUE);
  for (const Line& line : outlines) {
    auto* curve = new OGRLineString;  // owned by the shape
    add_points(*curve, line);
    shape->addGeometryDirectly(curve);
  }
  return shape;
}

PlanShape plan_shape(std::span<const glm::dvec3> corners_m, std::span<const glm::dvec3> on_map,
                     std::span<const Piece> pieces) {
  const std::vector<RingedPolygon> polygons = united(corners_m, pieces).value_or(apart(pieces));
  PlanShape shape;
  for (const RingedPolygon& polygon : polygons) {
    if (!has_plan_area(corners_m, polygon)) continue;
    shape.polygons.emplace_back();
    for (const auto& ring : polygon) shape.polygons.back().push_back(closed_line(on_map, ring));
  }
  if (!shape.polygons.empty() && OGRGeometryFactory::haveGEOS()) {
    const GdalMessages quiet;
    const std::unique_ptr<OGRMultiPolygon> geometry = shape.multi_polygon();
    if (!geometry->IsValid()) shape.polygons = mended(*geometry, shape);
  }
  if (!shape.polygons.empty()) return shape;
  for (const RingedPolygon& polygon : polygons)
    for (const auto& ring : polygon) {
      PlanShape::Line line = closed_line(on_map, ring);
      const bool has_length = std::ranges::any_of(
          line, [&](const glm::dvec3& p) { return p.x != line[0].x || p.y != line[0].y; });
      if (has_length) shape.outlines.push_back(std::move(line));
    }
  return shape;
}

}  // namespace tubefoot
