// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>

#include "engine/history.hpp"
#include "geometry/facet_mesh.hpp"
#include "geometry/world_grid.hpp"

namespace tubefoot {

/// A mesh made ready for rays: Embree's bounding volume hierarchy, built once and read by any number of pings
/// and threads. Embree computes in float, in metres from the grid's origin, so which facet a ray meets is
/// uncertain within about 1e-7 of the scene's size; ranges and angles are computed anew in double from the
/// grid.
class RayScene {
 public:
  /// `mesh` must outlive the scene. Throws std::runtime_error with Embree's message if Embree fails.
  RayScene(const FacetMesh& mesh, const WorldGrid& grid);
  ~RayScene();
  RayScene(RayScene&&) noexcept;
  RayScene& operator=(RayScene&&) noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
  friend History trace_rays(const RayScene&, TubeSet, double, std::int64_t, std::uint64_t);
};

/// The sampling engine: shares `rays` out among the tubes by solid angle, at least one a tube, and fills
/// History::hits, ordered by tube. In a tube the rays are stratified: its bilinear patch is cut into as many
/// cells as it has rays, each cell gets one direction, uniform in solid angle, and its hit carries the cell's
/// exact solid angle. The weights of a tube's rays, hits and misses together, are therefore the tube's solid
/// angle. `grid_unit_m` is the unit of the scene's grid. Nothing is met beyond tubes.reach; facets whose
/// plane contains the apex are passed through. Directions depend on (seed, tube, ray) alone: the result is
/// the same for any number of threads. Throws std::invalid_argument if rays < 0 or if a tube has no solid
/// angle (corner rays in one plane, or not convex).
History trace_rays(const RayScene& scene, TubeSet tubes, double grid_unit_m, std::int64_t rays,
                   std::uint64_t seed);

}  // namespace tubefoot
