// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/footprints/corner_derivatives.hpp"

#include <algorithm>
#include <glm/geometric.hpp>

// A corner is c = d offset / (normal . d). Here d is the direction of its ray, and normal . x = offset is the
// plane of its facet. A corner at a vertex of its facet is that vertex.

namespace tubefoot {
namespace {

/// The ray of a corner: its direction, and the normals whose product it is unless it passes through a point.
struct CornerRay {
  glm::dvec3 p{0}, q{0}, direction{0};
  CornerRay(const NamedPoints& points, const CornerName& corner) {
    if (corner.point != no_point) {
      direction = points.point(corner.point);
      return;
    }
    p = points.normal(corner.p);
    q = points.normal(corner.q);
    direction = glm::cross(p, q);
  }
};

bool is_vertex_of(const FacetMesh& mesh, const CornerName& corner, FacetId facet) {
  return corner.point != no_point &&
         std::ranges::find(mesh.facets[facet], corner.point) != mesh.facets[facet].end();
}

}  // namespace

glm::dvec3 NamedPoints::point(PointId id) const {
  const std::size_t vertices = context_.mesh.vertices.size();
  const GridPoint p =
      !(id & ray_bit) && id >= vertices ? part_->vertices[id - vertices] - context_.apex : context_.point(id);
  const glm::dvec3 at(p.x, p.y, p.z);
  return id & ray_bit ? at : unit_m_ * at;
}

NamedPoints::Plane NamedPoints::plane(FacetId facet) const {
  const auto& [a, b, c] = context_.mesh.facets[facet];
  const glm::dvec3 first = point(a), normal = glm::cross(point(b) - first, point(c) - first);
  return {normal, glm::dot(normal, first)};
}

glm::dvec3 NamedPoints::normal(const PlaneName& name) const {
  if (!name.depth) return glm::cross(point(name.a), point(name.b));
  const Plane one = plane(name.a), other = plane(name.b);
  return one.offset * other.normal - other.offset * one.normal;
}

glm::dvec3 NamedPoints::direction(const CornerName& corner) const {
  return CornerRay(*this, corner).direction;
}

void CornerVelocities::add_facet(FacetId facet, std::vector<NamedPoints::Plane>& by) const {
  const auto& [a, b, c] = points_.context().mesh.facets[facet];
  const glm::dvec3 first = points_.point(a), at_b = points_.point(b), at_c = points_.point(c);
  const glm::dvec3 to_b = at_b - first, to_c = at_c - first, across = glm::cross(to_b, to_c);
  by.resize(velocities_.size());
  for (std::size_t n = 0; n < by.size(); ++n) {
    const PointVelocity& of = velocities_[n];
    const glm::dvec3 by_a = of(a, first);
    const glm::dvec3 normal = glm::cross(of(b, at_b) - by_a, to_c) + glm::cross(to_b, of(c, at_c) - by_a);
    by[n] = {normal, glm::dot(normal, first) + glm::dot(across, by_a)};
  }
}

void CornerVelocities::add_normal(const PlaneName& name, std::vector<glm::dvec3>& by) {
  by.resize(velocities_.size());
  if (!name.depth) {
    const glm::dvec3 a = points_.point(name.a), b = points_.point(name.b);
    for (std::size_t n = 0; n < by.size(); ++n)
      by[n] = glm::cross(velocities_[n](name.a, a), b) + glm::cross(a, velocities_[n](name.b, b));
    return;
  }
  const NamedPoints::Plane one = points_.plane(name.a), other = points_.plane(name.b);
  add_facet(name.a, by_one_);
  add_facet(name.b, by_other_);
  for (std::size_t n = 0; n < by.size(); ++n)
    by[n] = by_one_[n].offset * other.normal + one.offset * by_other_[n].normal -
            by_other_[n].offset * one.normal - other.offset * by_one_[n].normal;
}

void CornerVelocities::select(FacetId facet) {
  facet_ = facet;
  plane_ = points_.plane(facet);
  add_facet(facet, by_plane_);
}

const std::vector<glm::dvec3>& CornerVelocities::of_corner(const CornerName& corner) {
  by_corner_.resize(velocities_.size());
  if (is_vertex_of(points_.context().mesh, corner, facet_)) {
    const glm::dvec3 at = points_.point(corner.point);
    for (std::size_t n = 0; n < by_corner_.size(); ++n) by_corner_[n] = velocities_[n](corner.point, at);
    return by_corner_;
  }
  of_direction(corner);
  const glm::dvec3& ray = direction_;
  const double along = glm::dot(plane_.normal, ray), scale = plane_.offset / along;
  for (std::size_t n = 0; n < by_corner_.size(); ++n) {
    const NamedPoints::Plane& by = by_plane_[n];
    const double by_scale =
        (by.offset - scale * (glm::dot(by.normal, ray) + glm::dot(plane_.normal, by_direction_[n]))) / along;
    by_corner_[n] = scale * by_direction_[n] + by_scale * ray;
  }
  return by_corner_;
}

const std::vector<glm::dvec3>& CornerVelocities::of_direction(const CornerName& corner) {
  by_direction_.resize(velocities_.size());
  const CornerRay ray(points_, corner);
  const bool through_point = corner.point != no_point;
  if (!through_point) {
    add_normal(corner.p, by_p_);
    add_normal(corner.q, by_q_);
  }
  direction_ = ray.direction;
  for (std::size_t n = 0; n < by_direction_.size(); ++n)
    by_direction_[n] = through_point ? velocities_[n](corner.point, ray.direction)
                                     : glm::cross(by_p_[n], ray.q) + glm::cross(ray.p, by_q_[n]);
  return by_direction_;
}

CornerVelocities::UnitPlane CornerVelocities::of_plane(std::size_t number) const {
  const NamedPoints::Plane& by = by_plane_[number];
  const double length = glm::length(plane_.normal), side = plane_.offset < 0 ? -1 : 1;
  const glm::dvec3 unit = plane_.normal / length;
  const double stretched = glm::dot(unit, by.normal);
  return {-side / length * (by.normal - stretched * unit),
          side / length * (by.offset - plane_.offset / length * stretched)};
}

CornerAdjoint::CornerAdjoint(const NamedPoints& points)
    : points_(points),
      by_vertex_(points.context().mesh.vertices.size(), glm::dvec3(0)),
      by_ray_(points.context().rays.size(), glm::dvec3(0)) {}

void CornerAdjoint::add_facet(FacetId facet, glm::dvec3 by_normal, double by_offset) {
  const auto& [a, b, c] = points_.context().mesh.facets[facet];
  const glm::dvec3 first = points_.point(a), to_b = points_.point(b) - first, to_c = points_.point(c) - first;
  by_normal += by_offset * first;
  const glm::dvec3 by_b = glm::cross(to_c, by_normal), by_c = glm::cross(by_normal, to_b);
  add(a, by_offset * glm::cross(to_b, to_c) - by_b - by_c);
  add(b, by_b);
  add(c, by_c);
}

void CornerAdjoint::add_normal(const PlaneName& name, glm::dvec3 by_normal) {
  if (!name.depth) {
    add(name.a, glm::cross(points_.point(name.b), by_normal));
    add(name.b, glm::cross(by_normal, points_.point(name.a)));
    return;
  }
  const NamedPoints::Plane one = points_.plane(name.a), other = points_.plane(name.b);
  add_facet(name.a, -other.offset * by_normal, glm::dot(by_normal, other.normal));
  add_facet(name.b, one.offset * by_normal, -glm::dot(by_normal, one.normal));
}

void CornerAdjoint::add_corner(const CornerName& corner, FacetId facet, glm::dvec3 by_corner) {
  if (is_vertex_of(points_.context().mesh, corner, facet)) {
    add(corner.point, by_corner);
    return;
  }
  const CornerRay ray(points_, corner);
  const NamedPoints::Plane plane = points_.plane(facet);
  const double along = glm::dot(plane.normal, ray.direction), scale = plane.offset / along,
               by_offset = glm::dot(by_corner, ray.direction) / along;
  add_facet(facet, -by_offset * scale * ray.direction, by_offset);
  add_direction(corner, scale * (by_corner - by_offset * plane.normal));
}

void CornerAdjoint::add_direction(const CornerName& corner, glm::dvec3 by_direction) {
  if (corner.point != no_point) {
    add(corner.point, by_direction);
    return;
  }
  const CornerRay ray(points_, corner);
  add_normal(corner.p, glm::cross(ray.q, by_direction));
  add_normal(corner.q, glm::cross(by_direction, ray.p));
}

void CornerAdjoint::add_plane(FacetId facet, glm::dvec3 by_normal, double by_distance) {
  // Let s be the sign of the offset. Towards the apex the unit normal is -s normal / |normal|, and the
  // distance is s offset / |normal|.
  const NamedPoints::Plane plane = points_.plane(facet);
  const double length = glm::length(plane.normal), side = plane.offset < 0 ? -1 : 1;
  const glm::dvec3 unit = plane.normal / length;
  const glm::dvec3 across = by_normal - glm::dot(by_normal, unit) * unit;
  add_facet(facet, -side / length * (across + by_distance * plane.offset / length * unit),
            side * by_distance / length);
}

}  // namespace tubefoot
