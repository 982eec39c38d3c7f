// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>

#include "engine/rays/ray_sampling.hpp"
#include "engine/sight/history.hpp"
#include "geometry/mesh/facet_mesh.hpp"
#include "geometry/numbers/world_grid.hpp"

namespace tubefoot {

/// A mesh made ready for rays: Embree's bounding volume hierarchy, built once and read by any number of pings
/// and threads. Embree computes in float, in metres from the grid's origin, so which facet a ray meets is
/// uncertain within about 1e-7 of the scene's size; ranges and angles are computed anew in double from the
/// facets' planes (32 bytes a facet).
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
  friend void trace_rays(const RayScene&, const RayPlan&, std::int64_t, std::int64_t, History&);
};

/// The sampling engine: traces the rays that `settings` ask for and fills History::hits, in the order of
/// their tubes (columns: of their beams). `grid_unit_m` is the unit of the scene's grid; `beam_of_tube` as in
/// RayPlan. Nothing is met beyond tubes.reach; facets whose plane contains the apex are passed through. The
/// result is the same for any number of threads. Throws std::invalid_argument as RayPlan.
History trace_rays(const RayScene& scene, TubeSet tubes, double grid_unit_m, const RaySettings& settings,
                   std::span<const std::uint32_t> beam_of_tube = {});

/// The same in portions, for any number of rays in little memory: `history` has tubes and grid unit already;
/// its hits are filled with the next portion before each call of `take`.
void trace_rays(const RayScene& scene, History& history, const RaySettings& settings,
                std::span<const std::uint32_t> beam_of_tube, const std::function<void()>& take);

/// The rays [first, end) of a plan for history.tubes: fills history.hits.
void trace_rays(const RayScene& scene, const RayPlan& plan, std::int64_t first, std::int64_t end,
                History& history);

}  // namespace tubefoot
