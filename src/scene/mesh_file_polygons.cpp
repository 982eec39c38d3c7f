// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/mesh_file_polygons.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <limits>
#include <span>

#include "files/input_error.hpp"
#include "geometry/stop.hpp"

namespace tubefoot {
namespace {

using Corners = std::span<const std::uint32_t>;

// Twice the vector area of a polygon (Newell).
glm::dvec3 vector_area(const std::vector<glm::dvec3>& points, Corners polygon) {
  glm::dvec3 area(0);
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    area += glm::cross(points[polygon[i]] - points[polygon[0]], points[polygon[i + 1]] - points[polygon[0]]);
  }
  return area;
}

// The smallest triangle of the fan from a corner, signed by the polygon's own side: negative when the fan
// folds over.
double smallest_in_fan(const std::vector<glm::dvec3>& points, Corners polygon, std::size_t start,
                       glm::dvec3 area) {
  const glm::dvec3 apex = points[polygon[start]];
  double smallest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    const glm::dvec3 b = points[polygon[(start + i) % polygon.size()]];
    const glm::dvec3 c = points[polygon[(start + i + 1) % polygon.size()]];
    smallest = std::min(smallest, glm::dot(glm::cross(b - apex, c - apex), area));
  }
  return smallest;
}

// A corner whose fan does not fold over, the earliest that makes no empty triangle; or none (polygon.size()).
std::size_t fan_start(const std::vector<glm::dvec3>& points, Corners polygon) {
  constexpr std::size_t kTries = 64;  // keeps a polygon of a million corners from taking hours
  const glm::dvec3 area = vector_area(points, polygon);
  std::size_t with_empty = polygon.size();
  for (std::size_t start = 0; start < std::min(polygon.size(), kTries); ++start) {
    const double smallest = smallest_in_fan(points, polygon, start, area);
    if (smallest > 0) return start;
    if (smallest == 0 && with_empty == polygon.size()) with_empty = start;
  }
  return with_empty;
}

}  // namespace

ComponentMesh triangulate(PolygonSoup soup, const std::string& file) {
  if (soup.end.empty()) {
    throw InputError({file, 0, 0}, "holds no facet, expected a surface mesh: export it with its faces");
  }
  ComponentMesh mesh;
  mesh.warnings = std::move(soup.warnings);
  std::size_t folded = 0, begin = 0;
  for (std::size_t face = 0; face < soup.end.size(); ++face) {
    stop_if_wanted();
    const Corners polygon(soup.corners.data() + begin, soup.end[face] - begin);
    begin = soup.end[face];
    const SourcePlace place{file, soup.line.empty() ? 0 : soup.line[face], 0};
    const std::string name = soup.line.empty() ? fmt::format("face {} (counted from 0)", face) : "the face";
    if (polygon.size() < 3) {
      throw InputError(place, fmt::format("{} has {} corners, expected at least 3", name, polygon.size()));
    }
    for (const std::uint32_t index : polygon) {
      if (index >= soup.points.size()) {
        throw InputError(
            place,
            fmt::format("{} names vertex {}, out of range: the file holds {} vertices, counted from {}", name,
                        std::uint64_t{index} + soup.first_index, soup.points.size(), soup.first_index));
      }
    }
    std::size_t start = polygon.size() == 3 ? 0 : fan_start(soup.points, polygon);
    if (start == polygon.size()) {
      ++folded;
      start = 0;
    }
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
      mesh.triangles.push_back(
          {polygon[start], polygon[(start + i) % polygon.size()], polygon[(start + i + 1) % polygon.size()]});
    }
  }
  mesh.points_m = std::move(soup.points);
  drop_unused_points(mesh);
  if (folded > 0) {
    mesh.warnings.push_back(
        fmt::format("{}: {} polygons are not star-shaped from a corner, their triangles overlap; "
                    "triangulate them in the modelling program",
                    file, folded));
  }
  return mesh;
}

}  // namespace tubefoot
