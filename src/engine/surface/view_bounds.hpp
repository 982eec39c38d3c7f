// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "engine/surface/sector.hpp"
#include "engine/water/ray_arc.hpp"
#include "geometry/mesh/facet_mesh.hpp"
#include "geometry/numbers/world_grid.hpp"
#include "geometry/search/scene_tree.hpp"

namespace tubefoot {

class ApparentMap;

/// Bounds the regions that a set of tubes may see in stratified water.
///
/// Rays stay in their vertical plane. A monotone ray rises or falls all the way. At some point it has the
/// grazing angle of the straight line to its end (a mean of cotangents over depth). By Snell's law, the
/// cosine of its launch angle is therefore the cosine of the straight line times a ratio of sound speeds.
/// The ratio is the speed at the apex over a speed between the slowest and the fastest on that side.
///
/// A ray that turns starts no steeper than a ray that is horizontal at the fastest depth of that side. Among
/// monotone rays with launch directions in the tubes, none reaches farther than the flattest one.
///
/// Over mirrors the same holds in the unfolded water. Everything behind the last mirror is invisible.
class ViewBounds {
 public:
  ViewBounds(const TubeSet& tubes, double grid_unit_m, const ApparentMap& apparent_map);
  /// Returns false only if no image of a point of the ball is within reach of the tubes. If the result is
  /// true for a ball, it is true for every ball that contains it.
  bool may_see(const glm::dvec3& centre_m, double radius_m) const;
  /// Does the same for the points of a box.
  bool may_see_box(const glm::dvec3& lowest_m, const glm::dvec3& highest_m) const;
  /// Does the same for the points of a triangle.
  bool may_see(const glm::dvec3 (&corners_m)[3]) const;
  /// Returns false only if no tube meets a ball at apparent positions. The centre is relative to the apex.
  bool may_show(const glm::dvec3& seen_m, double radius_m) const {
    return sector_.may_meet(seen_m, radius_m);
  }
  /// Returns the facets of a mesh that may be seen when they are displaced by up to `margin_m`, by
  /// increasing id.
  std::vector<FacetId> facets(const FacetMesh& mesh, const SceneTree& tree, const WorldGrid& grid,
                              double margin_m = 0) const;

 private:
  /// Bounds for one side of the apex, above or below.
  struct Side {
    double slowest = 1, fastest = 1;  ///< speed at the apex over the slowest and over the fastest speed
    /// Flattest ray of the tubes on this side.
    SnellRay flattest;
    /// States of the flattest ray at the borders of layers, from the apex on.
    struct Border {
      double way_m, speed_m_s, gradient_per_s, sine, range_m;
    };
    std::vector<Border> borders;
    /// Returns an upper bound of the range of the tubes' rays that have risen or fallen monotonically by
    /// `way_m`.
    double farthest_m(double way_m) const;
  };
  void trace_flattest(Side& side, bool down, double launch_sine);
  /// Tests points between two heights above the apex, whose plan positions lie in a convex hull. `nearest_m`
  /// is the point of the hull nearest to the apex, or 0 if the hull contains the apex.
  bool may_see(std::span<const glm::dvec2> ways_m, glm::dvec2 nearest_m, double lowest_m,
               double highest_m) const;
  /// Tests points within ranges of heights above the apex and of distances from its vertical, in the
  /// azimuths of `box`. Overwrites the elevations of `box`.
  bool may_see(DirectionBox& box, double lowest_m, double highest_m, double nearest_m,
               double farthest_m) const;

  Sector sector_;
  const ApparentMap& apparent_map_;
  glm::dvec3 apex_m_;
  Side above_, below_;
  DirectionBox turning_;  ///< elevations of rays that turn
  double stretch_ = 1;
};

}  // namespace tubefoot
