// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/footprints/facet_regions.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <span>
#include <utility>

#include "geometry/arithmetic/wide_direction.hpp"
#include "geometry/footprints/piece_walls.hpp"
#include "geometry/footprints/range_ring.hpp"
#include "geometry/steps/stop.hpp"

// Computes the polygons of visible pieces, of tubes and of range gates in a chart of one facet. Edges of
// visible pieces are exact images of planes through the apex. The circles of the range gate are replaced by
// polygons on the grid (range_ring.hpp).

namespace tubefoot {
namespace {

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

/// Returns the line from one grid point to the next, with the inside to its left.
PlaneLine line_between(std::int64_t u0, std::int64_t v0, std::int64_t u1, std::int64_t v1) {
  const HugeInt a = v0 - v1, b = u1 - u0;
  return PlaneLine::of(a, b, -(a * HugeInt(u0) + b * HugeInt(v0)));
}

LinePolygon polygon_round(const ChartCorners& corners, LineStore& store) {
  LinePolygon polygon;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto &a = corners[k], &b = corners[(k + 1) % 3];
    polygon.push_back(store.keep(line_between(a[0], a[1], b[0], b[1])));
  }
  return polygon;
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

FacetRegions::FacetRegions(const FacetMesh& mesh, FacetId facet, bool by_weights)
    : mesh_(mesh), facet_(facet), by_weights_(by_weights), chart_(facet_plane(mesh, facet)) {
  const FacetCone plane = facet_plane(mesh, facet);
  origin_ = plane.point[0];
  normal_ = plane.normal;
  for (std::size_t k = 0; k < 3; ++k) {
    corners_[k] = {coordinate(plane.point[k], chart_.u) - coordinate(origin_, chart_.u),
                   coordinate(plane.point[k], chart_.v) - coordinate(origin_, chart_.v)};
    if (by_weights) corners_[k] = {k == 1 ? whole_weight : 0, k == 2 ? whole_weight : 0};
  }
  triangle_ = polygon_round(corners_, store_);
  own_lines_ = store_.size();
  double_area_ = HugeInt(corners_[1][0]) * corners_[2][1] - HugeInt(corners_[1][1]) * corners_[2][0];
}

glm::dvec3 FacetRegions::in_space(glm::dvec2 corner) const {
  if (by_weights_) {
    const auto& [a, b, c] = mesh_.facets[facet_];
    const glm::dvec3 along = vector(mesh_.vertices[b]) - vector(mesh_.vertices[a]),
                     across = vector(mesh_.vertices[c]) - vector(mesh_.vertices[a]);
    constexpr auto whole = static_cast<double>(whole_weight);
    return vector(origin_) + along * (corner.x / whole) + across * (corner.y / whole);
  }
  const glm::dvec3 n = vector(normal_);
  glm::dvec3 point;
  point[chart_.u] = corner.x;
  point[chart_.v] = corner.y;
  point[chart_.w] = -(n[chart_.u] * corner.x + n[chart_.v] * corner.y) / n[chart_.w];
  return vector(origin_) + point;
}

FacetRegions::Aspect FacetRegions::aspect(const CoverageEnd& end, FacetId facet) {
  const FacetMesh& mesh = end.seabed ? *end.seabed->mesh : mesh_;
  Aspect from;
  from.end = &end;
  from.facet = facet;
  from.edge_on = !FacetCone::make(mesh, facet, end.tubes.apex, from.seen);
  for (std::size_t k = 0; k < 3; ++k) from.corners[k] = mesh.vertices[mesh.facets[facet][k]] - end.tubes.apex;
  from.on_chart = end.is_displaced(facet) ? end.weights_of(facet) : corners_;
  from.place = triangle_;
  if (from.on_chart == corners_) return from;
  thread_local std::vector<int> sides;
  for (const PlaneLine* line : polygon_round(from.on_chart, store_)) clip(from.place, *line, sides);
  return from;
}

std::vector<const PlaneLine*> FacetRegions::lines_round(std::span<const glm::dvec3> ring,
                                                        const Aspect& about) {
  std::vector<std::array<std::int64_t, 2>> corners;
  const glm::dvec3 along = vector(about.corners[1] - about.corners[0]),
                   across = vector(about.corners[2] - about.corners[0]), n = glm::cross(along, across);
  const auto at = [&](std::size_t k) {
    return glm::dvec2(about.on_chart[k][0] - about.on_chart[0][0],
                      about.on_chart[k][1] - about.on_chart[0][1]);
  };
  for (const glm::dvec3& p : ring) {
    if (!by_weights_) {
      corners.push_back({std::llround(p[chart_.u]), std::llround(p[chart_.v])});
      continue;
    }
    const glm::dvec2 q =
        (glm::dot(n, glm::cross(p, across)) * at(1) + glm::dot(n, glm::cross(along, p)) * at(2)) /
        glm::dot(n, n);
    corners.push_back({about.on_chart[0][0] + std::llround(q.x), about.on_chart[0][1] + std::llround(q.y)});
  }
  std::vector<const PlaneLine*> lines;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const auto& a = corners[k];
    const auto& b = corners[(k + 1) % corners.size()];
    lines.push_back(store_.keep(line_between(a[0], a[1], b[0], b[1])));
  }
  return lines;
}

FacetRegions::Window FacetRegions::window(const CoverageLook& look, const Aspect& tx, const Aspect* rx) {
  Window window;
  const FacetMesh& mesh = look.tx.seabed ? *look.tx.seabed->mesh : mesh_;
  const FacetMesh& there = rx != nullptr && rx->end->seabed ? *rx->end->seabed->mesh : mesh_;
  if (surely_in_window(look, mesh, tx.facet, there, rx ? rx->facet : tx.facet)) return window;
  const double least = by_weights_ ? 0 : least_ring;
  const auto ring = [&](double range, RingSide side) {
    if (rx != nullptr) {
      const auto places = [](const Aspect& of) {
        return std::array{vector(of.corners[0]), vector(of.corners[1]), vector(of.corners[2])};
      };
      if (rx->on_chart == tx.on_chart) return half_path_ring(places(tx), places(*rx), range, side, least);
      // The parts have been cut by the mirrors of each end separately. They belong to one facet at one
      // position.
      Aspect same = tx;
      const GridPoint apart = rx->end->tubes.apex - tx.end->tubes.apex;
      for (GridPoint& corner : same.corners) corner = corner - apart;
      return half_path_ring(places(tx), places(same), range, side, least);
    }
    const FacetCone plane = facet_plane(mesh, tx.facet);
    const glm::dvec3 n = glm::normalize(vector(plane.normal));
    glm::dvec3 other(0);
    other[FacetChart(plane).u] = 1;
    return range_ring(vector(tx.corners[0]), n, glm::normalize(other - n * glm::dot(n, other)), range, side,
                      least);
  };
  if (std::isfinite(look.farthest)) {
    window.outer = lines_round(ring(look.farthest, RingSide::inscribed), tx);
    window.none = window.outer.empty();
  }
  if (look.nearest > 0) window.inner = lines_round(ring(look.nearest, look.inner_side()), tx);
  return window;
}

TabledPolygon FacetRegions::tabled(const LinePolygon& polygon) {
  TabledPolygon result;
  for (const PlaneLine* line : polygon) {
    // All lines of the polygons of this class are in store_.
    const auto& stored = static_cast<const StoredLine&>(*line);
    if (!stored.number) stored.number = table_.keep(*line);
    result.lines.push_back(*stored.number);
  }
  for (std::size_t k = 0; k < result.lines.size(); ++k)
    result.corners.push_back(
        table_.corner(result.lines[k == 0 ? result.lines.size() - 1 : k - 1], result.lines[k]));
  return result;
}

void FacetRegions::add(const Window& window, LinePolygon polygon) {
  thread_local std::vector<int> sides;
  if (polygon.empty() || window.none) return;
  for (const PlaneLine* line : window.outer) {
    clip(polygon, *line, sides);
    if (polygon.empty()) return;
  }
  std::vector<LinePolygon> parts;
  if (window.inner.empty() || !split_off(polygon, window.inner, store_, parts)) parts.push_back(polygon);
  for (const LinePolygon& part : parts) border_.add(tabled(part));
  any_polygon_ = any_polygon_ || !parts.empty();
}

void FacetRegions::end_layer(CoverageLayer layer) {
  if (!any_polygon_) return;
  border_.finish(table_);
  layer.border = std::exchange(border_, {});
  any_polygon_ = false;
  layers_.push_back(std::move(layer));
}

const PlaneLine* FacetRegions::edge(const NameContext& context, const TubeVisibility& seen,
                                    const NamedPiece& piece, std::uint32_t k,
                                    std::span<const glm::dvec3> points, const Aspect& from) {
  const auto corners = std::span(seen.corners).subspan(piece.first, piece.count);
  if (const auto plane = shared_plane(corners[k], corners[(k + 1) % piece.count]))
    if (is_edge_of(from.seen.vertex, *plane)) return nullptr;
  PlaneLine line =
      PlaneLine::on_image(from.corners, from.on_chart, inward_normal(context, corners, k, points));
  return line.is_none() ? nullptr : store_.keep(std::move(line));
}

LinePolygon FacetRegions::seen(const Aspect& from, std::uint32_t tube, std::uint32_t index) {
  stop_if_wanted();
  const TubeVisibility& seen = from.end->seen[tube];
  const NamedPiece& piece = seen.pieces[index];
  const NameContext context{from.end->seabed ? *from.end->seabed->mesh : mesh_, from.end->tubes.apex,
                            seen.rays};
  thread_local std::vector<int> sides;
  thread_local std::vector<glm::dvec3> points;
  points.clear();
  for (std::uint32_t k = 0; k < piece.count; ++k)
    points.push_back(point_on_facet(context, seen.corners[piece.first + k], from.seen));
  LinePolygon polygon = from.place;
  for (std::uint32_t k = 0; k < piece.count && !polygon.empty(); ++k)
    if (const PlaneLine* line = edge(context, seen, piece, k, points, from)) clip(polygon, *line, sides);
  return polygon;
}

LinePolygon FacetRegions::within(const Aspect& from, std::uint32_t tube) {
  stop_if_wanted();
  const TubeSet& tubes = from.end->tubes;
  const Tube& rays = tubes.tubes[tube];
  thread_local std::vector<int> sides;
  LinePolygon polygon = from.place;
  for (std::size_t k = 0; k < 4 && !polygon.empty(); ++k) {
    const WideVec wall = widen(cross(tubes.rays[rays[k]], tubes.rays[rays[(k + 1) % 4]]));
    const PlaneLine line = PlaneLine::on_image(from.corners, from.on_chart,
                                               {HugeInt(wall[0]), HugeInt(wall[1]), HugeInt(wall[2])});
    if (!line.is_none()) {
      clip(polygon, *store_.keep(line), sides);
    } else if (line.c < 0) {
      polygon.clear();  // the wall is parallel to the facet, which lies outside
    }
  }
  return polygon;
}

bool surely_in_window(const CoverageLook& look, const FacetMesh& mesh, FacetId tx, const FacetMesh& there,
                      FacetId rx) {
  // The code bounds the range from each end separately and takes the mean.
  double farthest = 0, nearest = 0;
  const auto add = [&](const FacetMesh& its, FacetId facet, GridPoint apex) {
    double reach = 0;
    glm::dvec3 middle(0);
    std::array<glm::dvec3, 3> p;
    for (std::size_t k = 0; k < 3; ++k) {
      p[k] = vector(its.vertices[its.facets[facet][k]] - apex);
      reach = std::max(reach, glm::length(p[k]));
      middle += p[k] / 3.0;
    }
    double radius = 0;
    for (const glm::dvec3& q : p) radius = std::max(radius, glm::length(q - middle));
    farthest += reach;
    nearest += glm::length(middle) - radius;
  };
  add(mesh, tx, look.tx.tubes.apex);
  if (look.rx) {
    add(there, rx, look.rx->tubes.apex);
    farthest /= 2;
    nearest /= 2;
  }
  return farthest < look.farthest * (1 - 1e-9) && (!(look.nearest > 0) || nearest > look.nearest * 1.01);
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
