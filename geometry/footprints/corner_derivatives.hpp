// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <glm/vec3.hpp>
#include <utility>
#include <vector>

#include "geometry/arithmetic/exact_corner.hpp"
#include "geometry/mesh/facet_mesh.hpp"
#include "geometry/mesh/names.hpp"

// Derivatives of the corners of footprints by the vertices and rays that their names contain. The names, and
// so the combinatorics, stay fixed. Reverse mode: the derivative of a value by a corner becomes derivatives
// of the value by points (Griewank and Walther, Evaluating Derivatives, 2008, chapter 3).
namespace tubefoot {

/// Points of names and planes of facets, relative to the apex. Points of the mesh are in metres. Rays have
/// the length of their integers, which has no effect.
class NamedPoints {
 public:
  /// `context` must outlive this object. `unit_m`: metres per grid unit. `part`: a part of the mesh, whose
  /// vertex v is the point context.mesh.vertices.size() + v.
  NamedPoints(const NameContext& context, double unit_m, const FacetMesh* part = nullptr)
      : context_(context), unit_m_(unit_m), part_(part) {}

  /// The plane normal . x = offset of a facet. The normal is not normalised.
  struct Plane {
    glm::dvec3 normal{0};
    double offset = 0;
  };
  const NameContext& context() const { return context_; }
  glm::dvec3 point(PointId id) const;
  Plane plane(FacetId facet) const;
  /// Returns the normal of a plane through the apex.
  glm::dvec3 normal(const PlaneName& name) const;
  /// Returns the direction of the ray of a corner, or the opposite direction. It has any length.
  glm::dvec3 direction(const CornerName& corner) const;

 private:
  const NameContext& context_;
  double unit_m_;
  const FacetMesh* part_;
};

/// Velocity of a point relative to the apex, by its name and place. The unit of length is the metre for
/// vertices and the unit of the integers for rays.
using PointVelocity = std::function<glm::dvec3(PointId id, glm::dvec3 at)>;

/// Velocities of the plane of a facet and of corners on it, for several velocities of points at once.
class CornerVelocities {
 public:
  CornerVelocities(const NamedPoints& points, std::vector<PointVelocity> velocities)
      : points_(points), velocities_(std::move(velocities)), by_plane_(velocities_.size()) {}

  /// Selects the facet of the following calls.
  void select(FacetId facet);
  /// The velocity of a facet's plane: of its unit normal towards the apex, and of its distance from the apex.
  struct UnitPlane {
    glm::dvec3 normal{0};
    double distance = 0;
  };
  UnitPlane of_plane(std::size_t number) const;
  /// Returns the velocities of a corner on the facet.
  const std::vector<glm::dvec3>& of_corner(const CornerName& corner);
  /// Returns the velocities of NamedPoints::direction(). No facet is needed.
  const std::vector<glm::dvec3>& of_direction(const CornerName& corner);

 private:
  void add_facet(FacetId facet, std::vector<NamedPoints::Plane>& by) const;
  void add_normal(const PlaneName& name, std::vector<glm::dvec3>& by);

  const NamedPoints& points_;
  std::vector<PointVelocity> velocities_;
  FacetId facet_ = 0;
  NamedPoints::Plane plane_;
  std::vector<NamedPoints::Plane> by_plane_, by_one_, by_other_;
  std::vector<glm::dvec3> by_corner_, by_direction_, by_p_, by_q_;
  glm::dvec3 direction_{0};  // of the last call of of_direction()
};

/// Derivatives of one value by the points of a mesh, per metre, and by the rays of a tube set, per unit of
/// their integers. Derivatives by a ray are perpendicular to the ray.
class CornerAdjoint {
 public:
  explicit CornerAdjoint(const NamedPoints& points);
  /// Calls `add` with each derivative by a point. by_vertex() and by_ray() stay empty.
  CornerAdjoint(const NamedPoints& points, std::function<void(PointId, glm::dvec3)> add)
      : points_(points), add_(std::move(add)) {}

  /// Adds the derivative of the value by the position of a corner on a facet, per metre.
  void add_corner(const CornerName& corner, FacetId facet, glm::dvec3 by_corner);
  /// Adds the derivative of the value by NamedPoints::direction().
  void add_direction(const CornerName& corner, glm::dvec3 by_direction);
  /// Adds the derivatives of the value by the facet's plane. The plane is given by its unit normal towards
  /// the apex and by its distance from the apex in metres.
  void add_plane(FacetId facet, glm::dvec3 by_normal, double by_distance);

  const std::vector<glm::dvec3>& by_vertex() const { return by_vertex_; }
  const std::vector<glm::dvec3>& by_ray() const { return by_ray_; }

 private:
  void add(PointId id, glm::dvec3 by) {
    if (add_) return add_(id, by);
    (id & ray_bit ? by_ray_[id & ~ray_bit] : by_vertex_[id]) += by;
  }
  void add_facet(FacetId facet, glm::dvec3 by_normal, double by_offset);
  void add_normal(const PlaneName& name, glm::dvec3 by_normal);

  const NamedPoints& points_;
  std::function<void(PointId, glm::dvec3)> add_;
  std::vector<glm::dvec3> by_vertex_, by_ray_;
};

}  // namespace tubefoot
