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

  const FacetMesh& mesh() const;
  /// Whether a place on a facet, `range_m` from an apex in a direction (unit), is met first there: what is
  /// met is that facet (`same` says which are), or as far as Embree's float can tell (a millionth of the
  /// range and of the apex's distance from the grid's origin). Facets whose plane contains the apex hide
  /// nothing.
  bool reaches(GridPoint apex, glm::dvec3 direction, double range_m,
               const std::function<bool(FacetId)>& same) const;

  struct State;
  const State& state() const { return *state_; }  ///< ray_tracing.hpp

 private:
  std::unique_ptr<State> state_;
};

/// Rays that mirrors send on, as they come from an image of their apex: turned, and only those that lie in
/// the image's windows, whose numbers hits have as tubes.
struct RaysOnwards {
  GridPoint apex;      ///< the image
  glm::dmat3 turn{1};  ///< of directions, orthogonal
  const TubeFinder& windows;
};

/// The sampling engine: traces the rays that `settings` ask for and fills History::hits, in the order of
/// their tubes (columns: of their beams; adaptive: first the pilots of all tubes, then the others).
/// `grid_unit_m` is the unit of the scene's grid; `beam_of_tube` as in RayPlan. Nothing is met beyond
/// tubes.reach; facets whose plane contains the apex are passed through. The result is the same for any
/// number of threads. Throws std::invalid_argument as RayPlan.
History trace_rays(const RayScene& scene, TubeSet tubes, double grid_unit_m, const RaySettings& settings,
                   std::span<const std::uint32_t> beam_of_tube = {}, const RayGuide* guide = nullptr);

/// The same in portions, for any number of rays in little memory: `history` has tubes and grid unit already;
/// its hits are filled with the next portion before each call of `take`. `onwards`: of rays over mirrors,
/// `scene` being what the image sees.
void trace_rays(const RayScene& scene, History& history, const RaySettings& settings,
                std::span<const std::uint32_t> beam_of_tube, const std::function<void()>& take,
                const RaysOnwards* onwards = nullptr, const RayGuide* guide = nullptr);

/// The rays [first, end) of a plan for history.tubes: fills history.hits.
void trace_rays(const RayScene& scene, const RayPlan& plan, std::int64_t first, std::int64_t end,
                History& history, const RaysOnwards* onwards = nullptr);

}  // namespace tubefoot
