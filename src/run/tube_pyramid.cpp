// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/tube_pyramid.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace tubefoot {
namespace {

glm::dvec3 from(const GridPoint& apex, const GridPoint& p) {
  return {double(p.x) - apex.x, double(p.y) - apex.y, double(p.z) - apex.z};
}

/// Clips a convex polygon by the half-space normal . p >= 0.
void clip(std::vector<glm::dvec3>& polygon, glm::dvec3 normal, std::vector<glm::dvec3>& scratch) {
  scratch.clear();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec3 a = polygon[i], b = polygon[(i + 1) % polygon.size()];
    const double da = glm::dot(normal, a), db = glm::dot(normal, b);
    if (da >= 0) scratch.push_back(a);
    if ((da > 0 && db < 0) || (da < 0 && db > 0)) scratch.push_back(a + (b - a) * (da / (da - db)));
  }
  polygon.swap(scratch);
}

}  // namespace

TubePyramid::TubePyramid(const TubeSet& tubes, std::size_t tube) : apex_(tubes.apex), ahead_(0) {
  std::array<glm::dvec3, 4> ray;
  for (std::size_t k = 0; k < 4; ++k) {
    const GridPoint& r = tubes.rays[tubes.tubes[tube][k]];
    ray[k] = glm::normalize(glm::dvec3(r.x, r.y, r.z));
    ahead_ += ray[k];
  }
  for (std::size_t k = 0; k < 4; ++k) {
    inward_[k] = glm::cross(ray[k], ray[(k + 1) % 4]);
    walls_[k] = {inward_[k].x, inward_[k].y, inward_[k].z};
  }
}

bool TubePyramid::may_meet(const GridPoint& lowest, const GridPoint& highest) const {
  const glm::dvec3 lo = from(apex_, lowest), hi = from(apex_, highest);
  const auto farthest_along = [&](const glm::dvec3& normal) {
    double sum = 0;
    for (int k = 0; k < 3; ++k) sum += normal[k] * (normal[k] > 0 ? hi[k] : lo[k]);
    return sum;
  };
  return farthest_along(ahead_) >= 0 &&
         std::ranges::all_of(inward_, [&](const glm::dvec3& normal) { return farthest_along(normal) >= 0; });
}

const std::vector<glm::dvec3>& TubePyramid::part_of(const FacetMesh& mesh, FacetId facet) {
  polygon_.clear();
  for (const VertexId v : mesh.facets[facet]) polygon_.push_back(from(apex_, mesh.vertices[v]));
  // The side planes of a pyramid also bound a second pyramid behind the apex.
  clip(polygon_, ahead_, scratch_);
  for (const glm::dvec3& normal : inward_) clip(polygon_, normal, scratch_);
  return polygon_;
}

}  // namespace tubefoot
