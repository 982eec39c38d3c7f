// SPDX-License-Identifier: GPL-3.0-or-later

// Triangulates polygons exactly with CGAL's constrained Delaunay triangulation. The winding number of each
// face decides whether it lies inside; a polygon with winding numbers other than 0 and 1 is rejected.

#include "scene/meshes/polygon_cutter.hpp"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <map>
#include <optional>
#include <utility>

#include "geometry/mesh/shuffled.hpp"
#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

using Corners = std::span<const std::uint32_t>;

/// Returns twice the vector area of a polygon (Newell).
glm::dvec3 vector_area(const std::vector<glm::dvec3>& points, Corners polygon) {
  glm::dvec3 area(0);
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
    area += glm::cross(points[polygon[i]] - points[polygon[0]], points[polygon[i + 1]] - points[polygon[0]]);
  return area;
}

int largest_axis(glm::dvec3 v) {
  v = glm::abs(v);
  return v.x >= v.y && v.x >= v.z ? 0 : v.y >= v.z ? 1 : 2;
}

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_2;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<std::uint32_t, Kernel>;
using FaceBase =
    CGAL::Triangulation_face_base_with_info_2<std::optional<int>, Kernel,
                                              CGAL::Constrained_triangulation_face_base_2<Kernel>>;
using Triangulation =
    CGAL::Constrained_Delaunay_triangulation_2<Kernel,
                                               CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>,
                                               CGAL::No_constraint_intersection_requiring_constructions_tag>;
using Vertex = Triangulation::Vertex_handle;

bool on_one_line(const std::vector<glm::dvec3>& points, Corners polygon) {
  // The line leads from the first corner to the farthest one. Points within rounding of the line count as
  // on it.
  const glm::dvec3 first = points[polygon[0]];
  const auto farther = [&](std::uint32_t a, std::uint32_t b) {
    return glm::distance(points[a], first) < glm::distance(points[b], first);
  };
  const glm::dvec3 along = points[*std::ranges::max_element(polygon, farther)] - first;
  const double length = glm::length(along);
  constexpr double rounding = 1e-12;
  return std::ranges::all_of(polygon, [&](std::uint32_t corner) {
    return glm::length(glm::cross(points[corner] - first, along)) <= rounding * length * length;
  });
}

}  // namespace

struct PolygonCutter::Plane {
  std::vector<std::uint32_t> corners;  ///< corners of the polygon, without repeated ones
  std::vector<Point> places;           ///< by corner
  Triangulation triangulation;
  std::vector<Vertex> vertices;  ///< by corner
  /// Number of times that the border runs from one vertex to the next along an edge.
  std::map<std::pair<Vertex, Vertex>, int> runs;
  std::vector<Triangle> found;

  void look_at(const std::vector<glm::dvec3>& points, Corners polygon, glm::dvec3 area) {
    corners.clear();
    places.clear();
    const int axis = largest_axis(area);
    for (const std::uint32_t corner : polygon) {
      const glm::dvec3& p = points[corner];
      // The view is from the side that the polygon faces, so that it is counter-clockwise.
      Point place(p[(axis + 1) % 3], p[(axis + 2) % 3]);
      if (area[axis] < 0) place = Point(place.y(), place.x());
      if (!corners.empty() && points[corners.back()] == p) continue;
      corners.push_back(corner);
      places.push_back(place);
    }
    while (corners.size() > 1 && points[corners.front()] == points[corners.back()]) {
      corners.pop_back();
      places.pop_back();
    }
  }

  bool turns_left(std::size_t a, std::size_t b, std::size_t c) const {
    return CGAL::orientation(places[a], places[b], places[c]) == CGAL::LEFT_TURN;
  }

  /// Divides triangles and most quadrilaterals, which are by far the most frequent polygons.
  bool cut_few(std::vector<Triangle>& triangles) const {
    const auto add = [&](std::size_t a, std::size_t b, std::size_t c) {
      triangles.push_back({corners[a], corners[b], corners[c]});
    };
    if (corners.size() == 3 && turns_left(0, 1, 2)) return add(0, 1, 2), true;
    if (corners.size() != 4) return false;
    if (turns_left(0, 1, 2) && turns_left(0, 2, 3)) return add(0, 1, 2), add(0, 2, 3), true;
    if (turns_left(1, 2, 3) && turns_left(1, 3, 0)) return add(1, 2, 3), add(1, 3, 0), true;
    return false;
  }

  /// Returns false if two edges cross, or if two different corners project to one point.
  bool insert(const std::vector<glm::dvec3>& points) {
    triangulation.clear();
    vertices.clear();
    runs.clear();
    Triangulation::Face_handle beside;  // consecutive corners are close together
    for (std::size_t i = 0; i < corners.size(); ++i) {
      stop_if_wanted();
      const std::size_t known = triangulation.number_of_vertices();
      const Vertex vertex = triangulation.insert(places[i], beside);
      beside = vertex->face();
      if (triangulation.number_of_vertices() > known) vertex->info() = corners[i];
      if (points[vertex->info()] != points[corners[i]]) return false;
      vertices.push_back(vertex);
    }
    try {
      for (const std::size_t i : shuffled(vertices.size())) {
        stop_if_wanted();
        triangulation.insert_constraint(vertices[i], vertices[(i + 1) % vertices.size()]);
      }
    } catch (const Triangulation::Intersection_of_constraints_exception&) {
      return false;
    }
    for (std::size_t i = 0; i < vertices.size(); ++i) run(vertices[i], vertices[(i + 1) % vertices.size()]);
    return true;
  }

  /// Follows an edge of the polygon through all vertices that lie on it.
  void run(Vertex from, Vertex to) {
    while (from != to) {
      stop_if_wanted();
      Vertex next = to;
      auto around = triangulation.incident_vertices(from);
      const auto first = around;
      do {
        if (triangulation.is_infinite(around)) continue;
        if (CGAL::orientation(from->point(), around->point(), to->point()) == CGAL::COLLINEAR &&
            CGAL::collinear_are_strictly_ordered_along_line(from->point(), around->point(), to->point()))
          next = around;
      } while (++around != first);
      ++runs[{from, next}];
      from = next;
    }
  }

  int runs_along(Vertex from, Vertex to) const {
    const auto known = runs.find({from, to});
    return known == runs.end() ? 0 : known->second;
  }

  /// Computes the winding number of each face, from the outside in. Returns false if one is neither 0 nor
  /// 1.
  bool wind() {
    std::vector<Triangulation::Face_handle> left;
    const auto set = [&](Triangulation::Face_handle face, int winding) {
      if (face->info()) return;
      face->info() = winding;
      left.push_back(face);
    };
    for (auto face : triangulation.all_face_handles()) face->info().reset();
    set(triangulation.infinite_face(), 0);
    while (!left.empty()) {
      const auto face = left.back();
      left.pop_back();
      const int winding = *face->info();
      if (winding != 0 && winding != 1) return false;
      for (int k = 0; k < 3; ++k) {
        // The face is to the left of this edge.
        const Vertex a = face->vertex(Triangulation::ccw(k)), b = face->vertex(Triangulation::cw(k));
        set(face->neighbor(k), winding - runs_along(a, b) + runs_along(b, a));
      }
    }
    return true;
  }

  bool cut_many(const std::vector<glm::dvec3>& points, std::vector<Triangle>& triangles) {
    if (!insert(points)) return false;
    if (triangulation.dimension() < 2 || !wind()) return false;
    found.clear();
    for (auto face : triangulation.finite_face_handles()) {
      if (*face->info() != 1) continue;
      Triangle t{face->vertex(0)->info(), face->vertex(1)->info(), face->vertex(2)->info()};
      std::rotate(t.begin(), std::ranges::min_element(t), t.end());
      found.push_back(t);
    }
    // The result does not depend on CGAL's order.
    std::ranges::sort(found);
    triangles.insert(triangles.end(), found.begin(), found.end());
    return true;
  }
};

PolygonCutter::PolygonCutter() : plane_(std::make_unique<Plane>()) {}
PolygonCutter::~PolygonCutter() = default;

PolygonCutter::Result PolygonCutter::cut(const std::vector<glm::dvec3>& points, Corners polygon,
                                         std::vector<Triangle>& triangles) {
  if (polygon.size() == 3) {
    triangles.push_back({polygon[0], polygon[1], polygon[2]});
    return Result::cut;
  }
  plane_->look_at(points, polygon, vector_area(points, polygon));
  if (plane_->cut_few(triangles)) return Result::cut;
  if (on_one_line(points, polygon)) {
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
      triangles.push_back({polygon[0], polygon[i], polygon[i + 1]});
    return Result::no_area;
  }
  return plane_->cut_many(points, triangles) ? Result::cut : Result::crossed;
}

double unevenness(const std::vector<glm::dvec3>& points, Corners polygon) {
  if (polygon.size() == 3) return 0;
  const glm::dvec3 area = vector_area(points, polygon);
  const double length = glm::length(area);
  if (length == 0) return 0;
  glm::dvec3 middle(0);
  double largest = 0;
  for (const std::uint32_t corner : polygon) {
    middle += points[corner] / static_cast<double>(polygon.size());
    const glm::dvec3 size = glm::abs(points[corner]);
    largest = std::max({largest, size.x, size.y, size.z});
  }
  double farthest = 0;
  for (const std::uint32_t corner : polygon)
    farthest = std::max(farthest, std::abs(glm::dot(points[corner] - middle, area / length)));
  // Rounding of single precision in three coordinates and in the plane through them, and of texts with few
  // digits.
  constexpr double rounding = 4 * 0x1p-24, of_size = 1e-3;
  return farthest > std::max(rounding * largest, of_size * std::sqrt(length)) ? farthest : 0;
}

}  // namespace tubefoot
