// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/rays/ray_planes.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "geometry/numbers/int128.hpp"

namespace tubefoot {
namespace {

/// Returns whether the apex lies exactly in the plane of a facet, for corners relative to the apex in grid
/// units.
bool plane_holds_apex(const std::array<std::array<std::int64_t, 3>, 3>& p) {
  const auto minor = [&](int i, int j) { return Int128(p[1][i]) * p[2][j] - Int128(p[1][j]) * p[2][i]; };
  return p[0][0] * minor(1, 2) + p[0][1] * minor(2, 0) + p[0][2] * minor(0, 1) == 0;
}

}  // namespace

RayPlanes::RayPlanes(const FacetMesh& mesh, double unit_m) : mesh_(&mesh), unit_m_(unit_m) {
  planes_.resize(mesh.facets.size());
  for (FacetId facet = 0; facet < planes_.size(); ++facet) planes_[facet] = plane_of(facet);
}

RayPlane RayPlanes::plane_of(FacetId facet) const {
  const auto& [a, b, c] = mesh_->facets[facet];
  const GridPoint &p = mesh_->vertices[a], &q = mesh_->vertices[b], &r = mesh_->vertices[c];
  const Int128 qx = Int128(q.x) - p.x, qy = Int128(q.y) - p.y, qz = Int128(q.z) - p.z;
  const Int128 rx = Int128(r.x) - p.x, ry = Int128(r.y) - p.y, rz = Int128(r.z) - p.z;
  const Int128 nx = qy * rz - qz * ry, ny = qz * rx - qx * rz, nz = qx * ry - qy * rx;
  if (nx == 0 && ny == 0 && nz == 0) return {0, 0, 0, 0};
  const glm::dvec3 normal{double(nx), double(ny), double(nz)};
  const double length = glm::length(normal);
  const glm::dvec3 unit = normal / length;
  return {unit.x, unit.y, unit.z, double(nx * p.x + ny * p.y + nz * p.z) / length * unit_m_};
}

bool RayPlanes::meet(GridPoint apex, glm::dvec3 direction, double embree_range_m, RayHit& hit) const {
  const RayPlane& plane = planes_[hit.facet];
  const glm::dvec3 normal(plane.x, plane.y, plane.z);
  const glm::dvec3 place = unit_m_ * glm::dvec3(apex.x, apex.y, apex.z);
  const double across = glm::dot(normal, place), offset = plane.distance_m - across;
  const double descent = glm::dot(normal, direction), range = offset / descent;
  hit.slant_range_m = range;
  hit.sine_grazing = std::abs(descent);
  const auto corners = [&] {
    std::array<std::array<std::int64_t, 3>, 3> p{};
    for (int k = 0; k < 3; ++k) {
      const GridPoint& vertex = mesh_->vertices[mesh_->facets[hit.facet][k]];
      p[k] = {std::int64_t(vertex.x) - apex.x, std::int64_t(vertex.y) - apex.y,
              std::int64_t(vertex.z) - apex.z};
    }
    return p;
  };
  // The bounds are those of meet_planes().
  if (std::abs(offset) <= 1e-13 * (std::abs(plane.distance_m) + glm::length(place)) &&
      plane_holds_apex(corners()))
    return false;
  if (hit.sine_grazing < 0.01 || !(std::abs(range - embree_range_m) <= 1e-6 * embree_range_m)) {
    double farthest = 0;
    for (const auto& p : corners())
      farthest = std::max(farthest, unit_m_ * glm::length(glm::dvec3(p[0], p[1], p[2])));
    hit.slant_range_m =
        range > 0 ? std::clamp(range, std::min(std::abs(offset), farthest), farthest) : embree_range_m;
  }
  return true;
}

void RayPlanes::meet(GridPoint apex, const RayPacket& rays, const std::array<FacetId, RayPacket::size>& facet,
                     const float* embree_range_m, MetPlanes& met) const {
  const glm::dvec3 place = unit_m_ * glm::dvec3(apex.x, apex.y, apex.z);
  meet_planes(planes_.data(), facet, place, glm::length(place), rays, embree_range_m, met);
}

}  // namespace tubefoot
