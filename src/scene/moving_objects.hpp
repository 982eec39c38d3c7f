// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <vector>

#include "engine/relief/wave_surface.hpp"
#include "geometry/mesh/facet_mesh.hpp"
#include "scene/description/scene_component.hpp"
#include "scene/trajectory.hpp"

namespace tubefoot {

struct Scene;
struct SourcePlace;

/// An object on a trajectory, or the sea surface. The vertices of its facets belong to no other component, so
/// that each time has its own vertices but the same facets.
struct MovingObject {
  std::uint16_t component = 0;
  std::size_t trajectory = 0;        ///< index in Scene::trajectories
  double lowest_m = 0;               ///< no vertex is lower at any ping
  Pose on_carrier;                   ///< the object's own axes and origin in the frame of its carrier
  std::vector<glm::dvec3> points_m;  ///< by vertex, in the object's own axes
  FacetMesh shape;                   ///< facets with vertex numbers of `points_m`; its vertices are unused
  /// of the sea surface: heights of its vertices above the mean plane, in which `points_m` lie; otherwise
  /// null. It has no trajectory, and it is the last moving object.
  std::shared_ptr<const WaveLattice> waves;
};

/// Makes the shape of a moving object from facets in its own axes. Points are welded as in a scene in which
/// the object rests at its origin. Adds to the numbers of `report`.
MovingObject moving_object(const ComponentMesh& mesh, const WorldGrid& grid, std::uint16_t component,
                           std::uint16_t material, MeshReport& report);

/// Makes the moving sea surface from its facets at the mean height.
MovingObject moving_sea_surface(const ComponentMesh& mesh, std::shared_ptr<const WaveLattice> waves,
                                std::uint16_t component, std::uint16_t material);

/// Returns the sea surface of a scene, or null if the scene has no facets of it.
const MovingObject* moving_sea_surface_of(const Scene& scene);

/// Returns the pose of a moving object at a time that its trajectory holds.
Pose pose_of(const MovingObject& object, const Trajectory& trajectory, double time_s);

/// Appends the moving objects to the facets at rest of a scene. Throws the errors of place_moving().
void add_moving(const Scene& scene, double time_s, FacetMesh& mesh);
/// Removes the moving objects, which are the last facets and vertices of a mesh.
void drop_moving(const Scene& scene, FacetMesh& mesh);
/// Returns the number of the first moving facet of a mesh with the moving objects of a scene.
FacetId first_moving_facet(const Scene& scene, const FacetMesh& mesh);
/// Moves the vertices of the moving objects to their places at a time. Throws InputError at the object's
/// place if its trajectory does not last until then, or leads out of the grid.
///
/// Law J1 (translation): if an object moves by a vector of the grid, each of its vertices moves by this
/// vector. The vertices are the snapped origin of the object plus the rotated points relative to the origin,
/// rounded to the grid.
void place_moving(const Scene& scene, double time_s, FacetMesh& mesh);

}  // namespace tubefoot
