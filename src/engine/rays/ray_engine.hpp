// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <glm/mat3x3.hpp>
#include <memory>
#include <span>

#include "engine/rays/ray_guide.hpp"
#include "engine/rays/ray_sampling.hpp"
#include "engine/visibility/history.hpp"
#include "geometry/mesh/facet_mesh.hpp"
#include "geometry/numbers/world_grid.hpp"
#include "geometry/tubes/tube_finder.hpp"

namespace tubefoot {

struct RaysOnwards;

/// A mesh prepared for rays: Embree's bounding volume hierarchy, built once and read by any number of pings
/// and threads. Embree computes in float, in metres from the grid's origin. The facet that a ray hits is
/// therefore uncertain within about 1e-7 of the scene's size. Ranges and angles are computed in double from
/// the facets' planes (32 bytes per facet).
class RayScene {
 public:
  /// `mesh` must outlive the scene. Throws std::runtime_error with Embree's message if Embree fails.
  RayScene(const FacetMesh& mesh, const WorldGrid& grid);
  ~RayScene();
  RayScene(RayScene&&) noexcept;
  RayScene& operator=(RayScene&&) noexcept;

  const FacetMesh& mesh() const;
  /// Returns whether a ray from the apex first meets the given point of a facet, `range_m` away in a unit
  /// direction. The first hit must be on the same facet, which `same` reports, or indistinguishable from it
  /// in Embree's float. The tolerance is a millionth of the range and of the apex's distance from the grid's
  /// origin. Facets whose plane contains the apex hide nothing.
  bool reaches(GridPoint apex, glm::dvec3 direction, double range_m,
               const std::function<bool(FacetId)>& same) const;

  struct State;
  const State& state() const { return *state_; }  ///< ray_tracing.hpp

 private:
  std::unique_ptr<State> state_;
};

/// Rays that mirrors reflect, as rays from an image of their apex. Directions are turned, and only rays
/// inside the image's apertures are traced. Hits have the numbers of these apertures as tubes.
struct RaysOnwards {
  GridPoint apex;      ///< the image of the apex
  glm::dmat3 turn{1};  ///< orthogonal matrix that turns directions
  const TubeFinder& windows;
};

/// The sampling engine. It traces the rays of `settings` and writes History::hits in the order of their
/// tubes. Columns are in the order of their beams; adaptive rays are first the pilots of all tubes and then
/// the others. `grid_unit_m` is the unit of the scene's grid; `beam_of_tube` is as in RayPlan. Nothing is hit
/// beyond tubes.reach, and rays pass through facets whose plane contains the apex. The result is the same for
/// any number of threads. Throws std::invalid_argument as RayPlan does.
History trace_rays(const RayScene& scene, TubeSet tubes, double grid_unit_m, const RaySettings& settings,
                   std::span<const std::uint32_t> beam_of_tube = {}, const RayGuide* guide = nullptr);

/// The same in portions, for any number of rays in little memory. `history` must have tubes and grid unit.
/// Its hits contain the next portion at each call of `take`. `onwards` describes reflected rays; `scene` is
/// then the part of the scene that the image sees.
void trace_rays(const RayScene& scene, History& history, const RaySettings& settings,
                std::span<const std::uint32_t> beam_of_tube, const std::function<void()>& take,
                const RaysOnwards* onwards = nullptr, const RayGuide* guide = nullptr);

/// Traces the rays [first, end) of a plan for history.tubes and writes history.hits.
void trace_rays(const RayScene& scene, const RayPlan& plan, std::int64_t first, std::int64_t end,
                History& history, const RaysOnwards* onwards = nullptr);

}  // namespace tubefoot
