// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh/plan_cut.hpp"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Object.h>
#include <CGAL/Spatial_sort_traits_adapter_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <CGAL/property_map.h>
#include <CGAL/spatial_sort.h>
#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <glm/common.hpp>
#include <limits>
#include <map>
#include <numeric>
#include <stdexcept>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "geometry/mesh/near_segments.hpp"
#include "geometry/mesh/segment_bins.hpp"
#include "geometry/mesh/shuffled.hpp"
#include "geometry/steps/steps.hpp"

// Cuts each facet in plan view with a constrained Delaunay triangulation of its edges and of the segments
// that meet it. Intersections are computed in rationals and rounded once at the end. Facets are cut in
// parallel; new points are welded in the order of the facets.

namespace tubefoot {
namespace {

using Signs = CGAL::Exact_predicates_inexact_constructions_kernel;
using Constructions = CGAL::Exact_predicates_exact_constructions_kernel;
using Exact = CGAL::Epeck_ft;
constexpr int unnumbered = -1;
using PlanVertex = CGAL::Triangulation_vertex_base_with_info_2<int, Constructions>;
using PlanFace = CGAL::Constrained_triangulation_face_base_2<Constructions>;
using PlanCdt = CGAL::Constrained_Delaunay_triangulation_2<
    Constructions, CGAL::Triangulation_data_structure_2<PlanVertex, PlanFace>, CGAL::Exact_predicates_tag>;

struct Facet {
  std::uint32_t id = 0;
  std::array<glm::dvec3, 3> corners;  ///< counter-clockwise seen from above
  bool turned = false;                ///< the facet itself turns clockwise
};

/// The parts of a facet. Points 0, 1 and 2 are its corners; new points follow.
struct Parts {
  std::vector<glm::dvec3> points;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

Signs::Point_2 plan(glm::dvec2 p) { return {p.x, p.y}; }

CGAL::Orientation turn(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) {
  return CGAL::orientation(plan(a), plan(b), plan(c));
}

/// Returns whether a segment and a closed facet have a common point: no line along the segment or an edge
/// separates them.
bool meets(const PlanSegment& s, const Facet& facet) {
  std::array<int, 3> count{0, 0, 0};
  for (unsigned k = 0; k < 3; ++k) {
    const glm::dvec2 from = facet.corners[k], to = facet.corners[(k + 1) % 3];
    if (turn(from, to, s.a) == CGAL::RIGHT_TURN && turn(from, to, s.b) == CGAL::RIGHT_TURN) return false;
    ++count[static_cast<unsigned>(turn(s.a, s.b, from) + 1)];
  }
  return count[0] != 3 && count[2] != 3;
}

/// Height of the facet's plane at a point of the plan, in rationals.
class PlaneHeight {
 public:
  explicit PlaneHeight(const std::array<glm::dvec3, 3>& corners) {
    for (unsigned k = 0; k < 3; ++k) x_[k] = corners[k].x, y_[k] = corners[k].y, z_[k] = corners[k].z;
    all_ = twice_area(x_[1], y_[1], x_[2], y_[2]);
  }
  Exact at(const Exact& x, const Exact& y) const {
    const Exact c = twice_area(x_[1], y_[1], x, y), b = twice_area(x, y, x_[2], y_[2]);
    return z_[0] + ((z_[1] - z_[0]) * b + (z_[2] - z_[0]) * c) / all_;
  }

 private:
  /// Returns twice the area of the triangle of corner 0 and two other points.
  Exact twice_area(const Exact& x1, const Exact& y1, const Exact& x2, const Exact& y2) const {
    return (x1 - x_[0]) * (y2 - y_[0]) - (x2 - x_[0]) * (y1 - y_[0]);
  }
  std::array<Exact, 3> x_, y_, z_;
  Exact all_;
};

/// The edges of a facet and the segments that meet it, with all points in which they meet each other. Every
/// point is a corner, an end, or computed from the two lines alone.
class Crossings {
 public:
  /// Computes the crossings of a facet with those of `segments` that meet it. `crossed` counts the crossings
  /// in all facets.
  Crossings(const Facet& facet, std::span<const PlanSegment> segments, const std::vector<std::uint32_t>& met,
            std::atomic<std::size_t>& crossed)
      : facet_(facet), crossed_(crossed), most_crossed_(crossings_allowed(segments.size())) {
    for (unsigned k = 0; k < 3; ++k) lines_.push_back({facet.corners[k], facet.corners[(k + 1) % 3]});
    for (const std::uint32_t k : met) lines_.push_back(segments[k]);
    on_.resize(lines_.size());
    for (std::uint32_t k = 0; k < lines_.size(); ++k) {
      add_end(lines_[k].a, k);
      add_end(lines_[k].b, k);
    }
    for_each_near_pair(lines_, [&](std::uint32_t i, std::uint32_t j) { meet(i, j); });
  }

  const std::vector<Constructions::Point_2>& points() const { return points_; }
  std::uint32_t corner(unsigned k) const {
    const glm::dvec3& p = facet_.corners[k];
    return number_.at({p.x + 0.0, p.y + 0.0});
  }
  std::size_t lines() const { return lines_.size(); }
  /// Returns the points on a line, from one end to the other. Points at equal positions may follow each
  /// other.
  std::vector<std::uint32_t> along(std::size_t line) {
    std::vector<std::uint32_t>& on = on_[line];
    const glm::dvec2 way = lines_[line].b - lines_[line].a;
    // Both coordinates are monotone along a line, so comparing them gives the order of the points.
    std::ranges::sort(on, [&](std::uint32_t p, std::uint32_t q) {
      const CGAL::Comparison_result x = CGAL::compare_x(points_[p], points_[q]);
      if (x != CGAL::EQUAL) return (x == CGAL::SMALLER) == (way.x > 0);
      const CGAL::Comparison_result y = CGAL::compare_y(points_[p], points_[q]);
      return y != CGAL::EQUAL && (y == CGAL::SMALLER) == (way.y > 0);
    });
    return on;
  }

 private:
  bool is_in_facet(glm::dvec2 p) const {
    for (unsigned k = 0; k < 3; ++k)
      if (turn(facet_.corners[k], facet_.corners[(k + 1) % 3], p) == CGAL::RIGHT_TURN) return false;
    return true;
  }
  bool is_in_facet(const Constructions::Point_2& p) const {
    for (unsigned k = 0; k < 3; ++k) {
      const glm::dvec2 a = facet_.corners[k], b = facet_.corners[(k + 1) % 3];
      if (CGAL::orientation(Constructions::Point_2(a.x, a.y), Constructions::Point_2(b.x, b.y), p) ==
          CGAL::RIGHT_TURN)
        return false;
    }
    return true;
  }
  void add_end(glm::dvec2 p, std::uint32_t line) {
    if (!is_in_facet(p)) return;
    const auto [known, is_new] =
        number_.try_emplace({p.x + 0.0, p.y + 0.0}, static_cast<std::uint32_t>(points_.size()));
    if (is_new) points_.emplace_back(p.x, p.y);
    if (on_[line].empty() || on_[line].back() != known->second) on_[line].push_back(known->second);
  }
  static bool is_between(glm::dvec2 a, glm::dvec2 p, glm::dvec2 b) {
    return std::min(a.x, b.x) <= p.x && p.x <= std::max(a.x, b.x) && std::min(a.y, b.y) <= p.y &&
           p.y <= std::max(a.y, b.y);
  }

  void meet(std::uint32_t i, std::uint32_t j) {
    const PlanSegment &s = lines_[i], &t = lines_[j];
    const CGAL::Orientation a = turn(t.a, t.b, s.a), b = turn(t.a, t.b, s.b);
    if (a == b && a != CGAL::COLLINEAR) return;
    const CGAL::Orientation c = turn(s.a, s.b, t.a), d = turn(s.a, s.b, t.b);
    if (c == d && c != CGAL::COLLINEAR) return;
    if (!pairs_.insert(std::uint64_t{i} << 32 | j).second) return;
    if (a != CGAL::COLLINEAR && b != CGAL::COLLINEAR && c != CGAL::COLLINEAR && d != CGAL::COLLINEAR)
      return cross(i, j);
    // An end of one segment lies on the other.
    if (a == CGAL::COLLINEAR && is_between(t.a, s.a, t.b)) add_end(s.a, j);
    if (b == CGAL::COLLINEAR && is_between(t.a, s.b, t.b)) add_end(s.b, j);
    if (c == CGAL::COLLINEAR && is_between(s.a, t.a, s.b)) add_end(t.a, i);
    if (d == CGAL::COLLINEAR && is_between(s.a, t.b, s.b)) add_end(t.b, i);
  }

  void cross(std::uint32_t i, std::uint32_t j) {
    const auto line = [](const PlanSegment& s) {
      return Constructions::Line_2(Constructions::Point_2(s.a.x, s.a.y),
                                   Constructions::Point_2(s.b.x, s.b.y));
    };
    // CGAL 5 returns Boost's variant and CGAL 6 that of the standard library. CGAL::Object accepts both.
    const CGAL::Object met = CGAL::intersection(line(lines_[i]), line(lines_[j]));
    const auto* point = CGAL::object_cast<Constructions::Point_2>(&met);
    if (point == nullptr) return;  // impossible for lines that cross
    // Points on edges of the facet (the first three lines) belong to the facet.
    if (i >= 3 && !is_in_facet(*point)) return;
    if (i >= 3 && ++crossed_ > most_crossed_)
      throw std::length_error(
          fmt::format("the borders cross each other more than {} times: dissolve the polygons that overlap, "
                      "or simplify them",
                      most_crossed_));
    on_[i].push_back(static_cast<std::uint32_t>(points_.size()));
    on_[j].push_back(static_cast<std::uint32_t>(points_.size()));
    points_.push_back(*point);
  }

  const Facet& facet_;
  std::atomic<std::size_t>& crossed_;
  std::size_t most_crossed_;
  std::vector<PlanSegment> lines_;
  std::vector<Constructions::Point_2> points_;
  std::vector<std::vector<std::uint32_t>> on_;  ///< per line: its points
  std::map<std::pair<double, double>, std::uint32_t> number_;
  std::unordered_set<std::uint64_t> pairs_;
};

/// Returns the points of the plan in an order in which neighbours follow each other.
std::vector<std::size_t> spatial_order(const std::vector<Constructions::Point_2>& points) {
  std::vector<Signs::Point_2> near;
  near.reserve(points.size());
  for (const Constructions::Point_2& p : points)
    near.emplace_back(CGAL::to_double(p.x()), CGAL::to_double(p.y()));
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  using Map = CGAL::Pointer_property_map<Signs::Point_2>::type;
  CGAL::spatial_sort(order.begin(), order.end(),
                     CGAL::Spatial_sort_traits_adapter_2<Signs, Map>(CGAL::make_property_map(near)));
  return order;
}

Parts cut(const Facet& facet, std::span<const PlanSegment> segments, const std::vector<std::uint32_t>& met,
          std::atomic<std::size_t>& crossed) {
  Crossings crossings(facet, segments, met, crossed);
  const std::vector<Constructions::Point_2>& points = crossings.points();
  // All points are inserted first, so that each constraint joins neighbours afterwards.
  PlanCdt cdt;
  std::vector<PlanCdt::Vertex_handle> vertex(points.size());
  PlanCdt::Face_handle beside;
  for (const std::size_t k : spatial_order(points)) {
    stop_if_wanted();
    vertex[k] = cdt.insert(points[k], beside);
    vertex[k]->info() = unnumbered;
    beside = vertex[k]->face();
  }
  // The order is pseudorandom, so that each constraint crosses few edges of the earlier ones.
  for (const std::size_t line : shuffled(crossings.lines())) {
    stop_if_wanted();
    const std::vector<std::uint32_t> along = crossings.along(line);
    for (std::size_t k = 1; k < along.size(); ++k)
      if (vertex[along[k - 1]] != vertex[along[k]])
        cdt.insert_constraint(vertex[along[k - 1]], vertex[along[k]]);
  }

  Parts parts;
  parts.points.assign(facet.corners.begin(), facet.corners.end());
  const PlaneHeight height(facet.corners);
  for (unsigned k = 0; k < 3; ++k) vertex[crossings.corner(k)]->info() = static_cast<int>(k);
  for (auto v = cdt.finite_vertices_begin(); v != cdt.finite_vertices_end(); ++v) {
    if (v->info() != unnumbered) continue;
    stop_if_wanted();
    v->info() = static_cast<int>(parts.points.size());
    // The double of an exact number does not depend on how the number was computed. The double of a lazy
    // number does.
    const Constructions::FT lazy_x = v->point().x(), lazy_y = v->point().y();
    const Exact &x = lazy_x.exact(), &y = lazy_y.exact();
    parts.points.emplace_back(CGAL::to_double(x), CGAL::to_double(y), CGAL::to_double(height.at(x, y)));
  }
  for (auto f = cdt.finite_faces_begin(); f != cdt.finite_faces_end(); ++f) {
    std::array<std::uint32_t, 3> triangle{};
    for (int k = 0; k < 3; ++k)
      triangle[static_cast<unsigned>(k)] = static_cast<std::uint32_t>(f->vertex(k)->info());
    if (facet.turned) std::swap(triangle[1], triangle[2]);
    parts.triangles.push_back(triangle);
  }
  return parts;
}

struct PointHash {
  std::size_t operator()(const glm::dvec3& p) const {
    std::uint64_t h = 0;
    for (int axis = 0; axis < 3; ++axis) {
      h = (h ^ std::bit_cast<std::uint64_t>(p[axis] + 0.0)) * 0x9e3779b97f4a7c15u;
      h ^= h >> 29;
    }
    return h;
  }
};

}  // namespace

PlanCut cut_in_plan(std::vector<glm::dvec3>& points,
                    const std::vector<std::array<std::uint32_t, 3>>& triangles,
                    std::span<const PlanSegment> segments) {
  glm::dvec2 lo(std::numeric_limits<double>::infinity()), hi(-lo);
  for (const glm::dvec3& p : points) lo = glm::min(lo, glm::dvec2(p)), hi = glm::max(hi, glm::dvec2(p));
  if (points.empty()) lo = hi = glm::dvec2(0);
  const SegmentBins bins(segments, lo, hi);

  std::vector<Facet> met_facets;
  std::vector<std::vector<std::uint32_t>> met;
  std::vector<std::uint32_t> near;
  for (std::uint32_t id = 0; id < triangles.size(); ++id) {
    stop_if_wanted();
    Facet facet{id, {points[triangles[id][0]], points[triangles[id][1]], points[triangles[id][2]]}};
    const glm::dvec2 a = facet.corners[0], b = facet.corners[1], c = facet.corners[2];
    near.clear();
    bins.near(glm::min(glm::min(a, b), c), glm::max(glm::max(a, b), c), near);
    if (near.empty()) continue;
    const CGAL::Orientation way = turn(a, b, c);
    facet.turned = way == CGAL::RIGHT_TURN;
    if (facet.turned) std::swap(facet.corners[1], facet.corners[2]);
    std::erase_if(near, [&](std::uint32_t k) { return !meets(segments[k], facet); });
    if (near.empty()) continue;
    if (way == CGAL::COLLINEAR)
      throw std::domain_error("a border meets a vertical facet, which cannot be cut in plan view");
    met_facets.push_back(facet);
    met.push_back(near);
  }
  std::vector<Parts> parts(met_facets.size());
  std::atomic<std::size_t> crossed{0};
  Steps steps("facets cut", parts.size());
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t k) {
    parts[k] = cut(met_facets[k], segments, met[k], crossed);
    steps.done();
  });

  PlanCut result;
  result.triangles.reserve(triangles.size());
  result.facet.reserve(triangles.size());
  const auto add = [&result](std::array<std::uint32_t, 3> triangle, std::uint32_t facet) {
    if (result.triangles.size() >= 0x80000000u)
      throw std::length_error("the borders cut the facets into more than 2^31 parts");
    result.triangles.push_back(triangle);
    result.facet.push_back(facet);
  };
  std::unordered_map<glm::dvec3, std::uint32_t, PointHash> number;
  std::size_t next = 0;
  for (std::uint32_t id = 0; id < triangles.size(); ++id) {
    stop_if_wanted();
    if (next == parts.size() || met_facets[next].id != id) {
      add(triangles[id], id);
      continue;
    }
    Parts part = std::move(parts[next]);
    const bool turned = met_facets[next++].turned;
    // Segments that only touch the facet's outline at its corners do not cut it.
    if (part.triangles.size() == 1) {
      add(triangles[id], id);
      continue;
    }
    ++result.cut_facets;
    std::vector<std::uint32_t> global{triangles[id][0], triangles[id][turned ? 2 : 1],
                                      triangles[id][turned ? 1 : 2]};
    for (std::size_t p = 3; p < part.points.size(); ++p) {
      const auto [found, is_new] =
          number.try_emplace(part.points[p], static_cast<std::uint32_t>(points.size()));
      if (is_new) {
        if (points.size() >= 0x80000000u)
          throw std::length_error("the borders cut the facets at more than 2^31 points");
        points.push_back(part.points[p]);
      }
      global.push_back(found->second);
    }
    for (const auto& [a, b, c] : part.triangles) add({global[a], global[b], global[c]}, id);
  }
  return result;
}

}  // namespace tubefoot
