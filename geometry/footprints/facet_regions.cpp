// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/footprints/facet_regions.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numbers>

#include "geometry/arithmetic/wide_direction.hpp"
#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

/// Sides of the polygons that stand for circles of one range on a facet.
constexpr int ring_sides = 96;
/// Smaller rings are not drawn: their corners, rounded to the grid, might not be convex. Grid units.
constexpr double least_ring = 8192;

glm::dvec3 vector(GridPoint p) { return {p.x, p.y, p.z}; }
glm::dvec3 vector(const Vec64& v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}

FacetCone facet_plane(const FacetMesh& mesh, FacetId facet) {
  FacetCone cone;
  cone.id = facet;
  cone.vertex = mesh.facets[facet];
  for (std::size_t k = 0; k < 3; ++k) cone.point[k] = mesh.vertices[cone.vertex[k]];
  cone.normal = cross(cone.point[1] - cone.point[0], cone.point[2] - cone.point[0]);
  return cone;
}

std::int64_t coordinate(GridPoint p, int axis) { return axis == 0 ? p.x : axis == 1 ? p.y : p.z; }

/// The line from one point of the grid to the next, inside to its left.
PlaneLine line_between(std::int64_t u0, std::int64_t v0, std::int64_t u1, std::int64_t v1) {
  const HugeInt a = v0 - v1, b = u1 - u0;
  return PlaneLine::of(a, b, -(a * HugeInt(u0) + b * HugeInt(v0)));
}

/// The one plane that two corners surely share, by name.
std::optional<PlaneName> shared_plane(const CornerName& x, const CornerName& y) {
  const auto through = [](const CornerName& corner, PointId point) -> std::optional<PlaneName> {
    if (corner.p.contains(point)) return corner.p;
    if (corner.q.contains(point)) return corner.q;
    return std::nullopt;
  };
  if (x.point != no_point && y.point != no_point) {
    if (x.point == y.point) return std::nullopt;
    return PlaneName{std::min(x.point, y.point), std::max(x.point, y.point), false};
  }
  if (x.point != no_point) return through(y, x.point);
  if (y.point != no_point) return through(x, y.point);
  const bool p = x.p == y.p || x.p == y.q, q = x.q == y.p || x.q == y.q;
  if (p == q) return std::nullopt;
  return p ? x.p : x.q;
}

bool is_edge_of(const std::array<VertexId, 3>& vertices, const PlaneName& plane) {
  const auto has = [&](PointId p) {
    return std::find(vertices.begin(), vertices.end(), p) != vertices.end();
  };
  return !plane.depth && has(plane.a) && has(plane.b);
}

}  // namespace

void ChartBox::include(glm::dvec2 point) {
  const glm::dvec2 error = 1e-14 * glm::abs(point);
  lo = glm::min(lo, point - error);
  hi = glm::max(hi, point + error);
}

std::vector<glm::dvec2> corners_of(const LinePolygon& polygon) {
  std::vector<glm::dvec2> corners;
  corners.reserve(polygon.size());
  for (std::size_t k = 0; k < polygon.size(); ++k)
    corners.push_back(meeting_point(*polygon[k == 0 ? polygon.size() - 1 : k - 1], *polygon[k]));
  return corners;
}

ChartBox box_of(const std::vector<glm::dvec2>& corners) {
  ChartBox box;
  for (const glm::dvec2& corner : corners) box.include(corner);
  return box;
}

bool split_off(LinePolygon& polygon, std::span<const PlaneLine* const> lines, LineStore& store,
               std::vector<LinePolygon>& parts) {
  thread_local std::vector<int> sides;
  LinePolygon common = polygon;
  for (const PlaneLine* line : lines) {
    clip(common, *line, sides);
    if (common.empty()) return false;
  }
  LinePolygon rest = polygon;
  for (const PlaneLine* line : lines) {
    if (std::find(common.begin(), common.end(), line) == common.end()) continue;  // cuts nothing off
    LinePolygon outside = rest;
    clip(outside, *store.opposite(*line), sides);
    if (!outside.empty()) parts.push_back(std::move(outside));
    clip(rest, *line, sides);
  }
  polygon = std::move(rest);
  return true;
}

FacetRegions::FacetRegions(const FacetMesh& mesh, FacetId facet)
    : mesh_(mesh), facet_(facet), chart_(facet_plane(mesh, facet)) {
  const FacetCone plane = facet_plane(mesh, facet);
  origin_ = plane.point[0];
  normal_ = plane.normal;
  std::array<std::int64_t, 3> u{}, v{};
  for (std::size_t k = 0; k < 3; ++k) {
    u[k] = coordinate(plane.point[k], chart_.u) - coordinate(origin_, chart_.u);
    v[k] = coordinate(plane.point[k], chart_.v) - coordinate(origin_, chart_.v);
  }
  for (std::size_t k = 0; k < 3; ++k)
    triangle_.push_back(store_.keep(line_between(u[k], v[k], u[(k + 1) % 3], v[(k + 1) % 3])));
  double_area_ = HugeInt(u[1]) * v[2] - HugeInt(v[1]) * u[2];
}

glm::dvec3 FacetRegions::in_space(glm::dvec2 corner) const {
  const glm::dvec3 n = vector(normal_);
  glm::dvec3 point;
  point[chart_.u] = corner.x;
  point[chart_.v] = corner.y;
  point[chart_.w] = -(n[chart_.u] * corner.x + n[chart_.v] * corner.y) / n[chart_.w];
  return vector(origin_) + point;
}

std::vector<const PlaneLine*> FacetRegions::ring(const Sight& sight, double radius, double along) {
  // Corners on the circle about the apex's foot point in the facet's plane, rounded to the grid of the chart.
  const glm::dvec3 n = glm::normalize(vector(normal_));
  glm::dvec3 other(0);
  other[chart_.u] = 1;
  const glm::dvec3 first = glm::normalize(other - n * glm::dot(n, other)), second = glm::cross(n, first);
  const glm::dvec3 foot = n * along - vector(sight.plane.point[0]);  // relative to the facet's first vertex
  std::vector<std::array<std::int64_t, 2>> corners;
  for (int k = 0; k < ring_sides; ++k) {
    const double angle = 2 * std::numbers::pi * k / ring_sides;
    const glm::dvec3 p = foot + radius * (std::cos(angle) * first + std::sin(angle) * second);
    corners.push_back({std::llround(p[chart_.u]), std::llround(p[chart_.v])});
  }
  std::vector<const PlaneLine*> lines;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const auto& a = corners[k];
    const auto& b = corners[(k + 1) % corners.size()];
    lines.push_back(store_.keep(line_between(a[0], a[1], b[0], b[1])));
  }
  return lines;
}

const FacetRegions::Sight& FacetRegions::sight(const CoverageLook& look, std::uint32_t number) {
  if (sight_.look == number) return sight_;
  sight_ = {};
  sight_.look = number;
  sight_.plane = facet_plane(mesh_, facet_);
  for (GridPoint& p : sight_.plane.point) p = p - look.tubes.apex;
  sight_.edge_on = !FacetCone::make(mesh_, facet_, look.tubes.apex, sight_.seen);
  if (sight_.edge_on || surely_in_window(mesh_, facet_, look)) return sight_;
  const double along = glm::dot(glm::normalize(vector(normal_)), vector(sight_.plane.point[0]));
  if (std::isfinite(look.farthest)) {
    const double radius2 = look.farthest * look.farthest - along * along;
    sight_.out_of_range = !(radius2 > least_ring * least_ring);
    if (!sight_.out_of_range) sight_.outer = ring(sight_, std::sqrt(radius2), along);
  }
  const double hole2 = look.nearest * look.nearest - along * along;
  if (hole2 > least_ring * least_ring)
    sight_.inner = ring(sight_, std::sqrt(hole2) / std::cos(std::numbers::pi / ring_sides), along);
  return sight_;
}

void FacetRegions::add(const Sight& sight, LinePolygon polygon, std::uint32_t ping, bool hidden_too) {
  thread_local std::vector<int> sides;
  for (const PlaneLine* line : sight.outer) {
    clip(polygon, *line, sides);
    if (polygon.empty()) return;
  }
  std::vector<LinePolygon> parts;
  if (sight.inner.empty() || !split_off(polygon, sight.inner, store_, parts)) parts.push_back(polygon);
  for (const LinePolygon& part : parts) {
    FacetRegion region{ping, sight.look, hidden_too, {}, box_of(corners_of(part))};
    for (const PlaneLine* line : part)
      if (std::find(triangle_.begin(), triangle_.end(), line) == triangle_.end())
        region.lines.push_back(line);
    regions_.push_back(std::move(region));
  }
}

const PlaneLine* FacetRegions::edge(const NameContext& context, const TubeVisibility& seen,
                                    const NamedPiece& piece, std::uint32_t k, const Sight& sight) {
  const auto corner = [&](std::uint32_t i) -> const CornerName& {
    return seen.corners[piece.first + i % piece.count];
  };
  if (const auto plane = shared_plane(corner(k), corner(k + 1))) {
    if (is_edge_of(sight.seen.vertex, *plane)) return nullptr;
    // The plane of a name has small coefficients. The piece lies on one side of it: the other corners say on
    // which. Doubles decide where they can.
    const WideVec normal = wide_normal(context, *plane);
    const glm::dvec3 near(normal[0].convert_to<double>(), normal[1].convert_to<double>(),
                          normal[2].convert_to<double>());
    int side = 0;
    bool mixed = false;
    for (std::uint32_t i = 2; i < piece.count; ++i) {
      const glm::dvec3 products = near * point_on_facet(context, corner(k + i), sight.seen);
      const double value = products.x + products.y + products.z;
      const double size = std::abs(products.x) + std::abs(products.y) + std::abs(products.z);
      int sign = value > 0 ? 1 : -1;
      if (!(std::abs(value) > 1e-13 * size))
        sign = dot(normal, wide_direction(context, corner(k + i))).sign();
      mixed = mixed || sign * side < 0;
      if (sign != 0) side = sign;
    }
    if (!mixed && side != 0) {
      std::array<HugeInt, 3> inward;
      for (std::size_t c = 0; c < 3; ++c) {
        inward[c] = HugeInt(normal[c]);
        if (side < 0) inward[c] = -inward[c];
      }
      PlaneLine line = PlaneLine::on_plane(sight.plane, chart_, inward);
      if (!line.is_none()) return store_.keep(std::move(line));
    }
  }
  PlaneLine line = PlaneLine::through(sight.plane, chart_, wide_direction(context, corner(k)),
                                      wide_direction(context, corner(k + 1)));
  return line.is_none() ? nullptr : store_.keep(std::move(line));
}

void FacetRegions::add_seen(const CoverageLook& look, std::uint32_t number, std::uint32_t tube,
                            std::uint32_t index) {
  stop_if_wanted();
  const Sight& from = sight(look, number);
  if (from.edge_on || from.out_of_range) return;
  const TubeVisibility& seen = look.seen[tube];
  const NamedPiece& piece = seen.pieces[index];
  const NameContext context{mesh_, look.tubes.apex, seen.rays};
  thread_local std::vector<int> sides;
  LinePolygon polygon = triangle_;
  for (std::uint32_t k = 0; k < piece.count && !polygon.empty(); ++k)
    if (const PlaneLine* line = edge(context, seen, piece, k, from)) clip(polygon, *line, sides);
  if (!polygon.empty()) add(from, std::move(polygon), look.ping, false);
}

void FacetRegions::add_within(const CoverageLook& look, std::uint32_t number, std::uint32_t tube) {
  const Sight& from = sight(look, number);
  if (from.edge_on || from.out_of_range) return;
  const Tube& rays = look.tubes.tubes[tube];
  thread_local std::vector<int> sides;
  LinePolygon polygon = triangle_;
  for (std::size_t k = 0; k < 4 && !polygon.empty(); ++k) {
    const WideVec wall = widen(cross(look.tubes.rays[rays[k]], look.tubes.rays[rays[(k + 1) % 4]]));
    const PlaneLine line =
        PlaneLine::on_plane(from.plane, chart_, {HugeInt(wall[0]), HugeInt(wall[1]), HugeInt(wall[2])});
    if (!line.is_none()) {
      clip(polygon, *store_.keep(line), sides);
    } else if (line.c < 0) {
      polygon.clear();  // the wall is parallel to the facet, which lies outside
    }
  }
  if (!polygon.empty()) add(from, std::move(polygon), look.ping, true);
}

bool surely_in_window(const FacetMesh& mesh, FacetId facet, const CoverageLook& look) {
  double farthest = 0;
  glm::dvec3 middle(0);
  std::array<glm::dvec3, 3> p;
  for (std::size_t k = 0; k < 3; ++k) {
    p[k] = vector(mesh.vertices[mesh.facets[facet][k]] - look.tubes.apex);
    farthest = std::max(farthest, glm::length(p[k]));
    middle += p[k] / 3.0;
  }
  if (!(farthest < look.farthest * (1 - 1e-9))) return false;
  if (!(look.nearest > 0)) return true;
  double radius = 0;
  for (const glm::dvec3& q : p) radius = std::max(radius, glm::length(q - middle));
  return glm::length(middle) - radius > look.nearest * 1.01;
}

bool is_whole_facet(const FacetMesh& mesh, const TubeVisibility& seen, const NamedPiece& piece) {
  for (std::uint32_t k = 0; k < piece.count; ++k) {
    const auto plane =
        shared_plane(seen.corners[piece.first + k], seen.corners[piece.first + (k + 1) % piece.count]);
    if (!plane || !is_edge_of(mesh.facets[piece.facet], *plane)) return false;
  }
  return true;
}

}  // namespace tubefoot
