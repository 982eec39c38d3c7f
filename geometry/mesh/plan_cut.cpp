// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh/plan_cut.hpp"

// Crossings of crossings are rare here, so the plain triangulation will do; it would print a warning.
#define CGAL_NO_CDT_2_WARNING
#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <tbb/parallel_for.h>

#include <bit>
#include <glm/common.hpp>
#include <limits>
#include <stdexcept>
#include <unordered_map>
#include <utility>

#include "geometry/mesh/segment_bins.hpp"
#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

using Signs = CGAL::Exact_predicates_inexact_constructions_kernel;
using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using Exact = CGAL::Epeck_ft;
constexpr int outside = -1, unnumbered = -2;
using Vertex = CGAL::Triangulation_vertex_base_with_info_2<int, Kernel>;
using Face = CGAL::Constrained_triangulation_face_base_2<Kernel>;
using Cdt =
    CGAL::Constrained_Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<Vertex, Face>,
                                               CGAL::Exact_intersections_tag>;

struct Facet {
  std::uint32_t id = 0;
  std::array<glm::dvec3, 3> corners;  ///< counter-clockwise seen from above
  bool turned = false;                ///< the facet itself turns the other way
};

/// What becomes of a facet: corners are points 0, 1 and 2, new points follow.
struct Parts {
  std::vector<glm::dvec3> points;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

Signs::Point_2 plan(glm::dvec2 p) { return {p.x, p.y}; }

CGAL::Orientation turn(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) {
  return CGAL::orientation(plan(a), plan(b), plan(c));
}

/// Whether segment and closed facet have a point in common: no line along an edge of either parts them.
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
  /// Of the triangle of corner 0 and two more points.
  Exact twice_area(const Exact& x1, const Exact& y1, const Exact& x2, const Exact& y2) const {
    return (x1 - x_[0]) * (y2 - y_[0]) - (x2 - x_[0]) * (y1 - y_[0]);
  }
  std::array<Exact, 3> x_, y_, z_;
  Exact all_;
};

Parts cut(const Facet& facet, std::span<const PlanSegment> segments, const std::vector<std::uint32_t>& met) {
  std::vector<Kernel::Point_2> points;
  std::vector<std::pair<std::size_t, std::size_t>> constraints{{0, 1}, {1, 2}, {2, 0}};
  for (const glm::dvec3& corner : facet.corners) points.emplace_back(corner.x, corner.y);
  for (const std::uint32_t k : met) {
    constraints.emplace_back(points.size(), points.size() + 1);
    points.emplace_back(segments[k].a.x, segments[k].a.y);
    points.emplace_back(segments[k].b.x, segments[k].b.y);
  }
  const std::array<Kernel::Point_2, 3> corner{points[0], points[1], points[2]};
  Cdt cdt;
  cdt.insert_constraints(points.begin(), points.end(), constraints.begin(), constraints.end());

  Parts parts;
  parts.points.assign(facet.corners.begin(), facet.corners.end());
  const PlaneHeight height(facet.corners);
  for (auto v = cdt.finite_vertices_begin(); v != cdt.finite_vertices_end(); ++v) {
    v->info() = unnumbered;
    for (unsigned k = 0; k < 3; ++k) {
      if (v->point() == corner[k]) v->info() = static_cast<int>(k);
      if (CGAL::orientation(corner[k], corner[(k + 1) % 3], v->point()) == CGAL::RIGHT_TURN) {
        v->info() = outside;
        break;
      }
    }
    if (v->info() != unnumbered) continue;
    v->info() = static_cast<int>(parts.points.size());
    // An exact number's double does not depend on how the number was come by; that of a lazy one does.
    const Kernel::FT lazy_x = v->point().x(), lazy_y = v->point().y();
    const Exact &x = lazy_x.exact(), &y = lazy_y.exact();
    parts.points.emplace_back(CGAL::to_double(x), CGAL::to_double(y), CGAL::to_double(height.at(x, y)));
  }
  for (auto f = cdt.finite_faces_begin(); f != cdt.finite_faces_end(); ++f) {
    std::array<std::uint32_t, 3> triangle{};
    bool inside = true;
    for (int k = 0; k < 3; ++k) {
      inside = inside && f->vertex(k)->info() != outside;
      triangle[static_cast<unsigned>(k)] = static_cast<std::uint32_t>(f->vertex(k)->info());
    }
    if (!inside) continue;
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
      throw std::domain_error("a facet that a border meets stands vertical: it cannot be cut in plan view");
    met_facets.push_back(facet);
    met.push_back(near);
  }
  std::vector<Parts> parts(met_facets.size());
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t k) {
    stop_if_wanted();
    parts[k] = cut(met_facets[k], segments, met[k]);
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
    // Segments that only touch the facet's outline at its corners leave it whole.
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
