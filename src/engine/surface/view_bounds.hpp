// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "engine/surface/sector.hpp"
#include "engine/water/apparent_map.hpp"
#include "geometry/mesh/facet_mesh.hpp"
#include "geometry/numbers/world_grid.hpp"
#include "geometry/search/scene_tree.hpp"

namespace tubefoot {

/// Where tubes may look through refracting water. Rays stay in their vertical plane. One that rises or falls
/// all the way has, somewhere on it, the grazing angle of the straight line to its end (a mean of cotangents
/// over depth), so that by Snell's law the cosine of its launch angle is that of the straight line, times the
/// sound speed at the apex over one between the slowest and the fastest on that side of it. One that turns is
/// launched no steeper than one that is level at the fastest place on that side. And of those that fall
/// (rise) all the way none that is launched like the tubes comes farther than the flattest of them. Over
/// mirrors all this is so in the unfolded water; what lies behind the last mirror is not seen.
class ViewBounds {
 public:
  ViewBounds(const TubeSet& tubes, double grid_unit_m, const ApparentMap& apparent_map);
  /// False only if no image of a point of the ball is in the tubes' reach. What is true for a ball is true
  /// for every ball that holds it.
  bool may_see(const glm::dvec3& centre_m, double radius_m) const;
  /// The same for the points of a box.
  bool may_see_box(const glm::dvec3& lowest_m, const glm::dvec3& highest_m) const;
  /// The same for the points of a triangle.
  bool may_see(const glm::dvec3 (&corners_m)[3]) const;
  /// False only if no tube meets a ball where it is seen, its centre told from the apex.
  bool may_show(const glm::dvec3& seen_m, double radius_m) const {
    return sector_.may_meet(seen_m, radius_m);
  }
  /// The facets of a mesh that may be seen when they are moved by up to `margin_m`, by increasing id.
  std::vector<FacetId> facets(const FacetMesh& mesh, const SceneTree& tree, const WorldGrid& grid,
                              double margin_m = 0) const;

 private:
  /// One side of the apex.
  struct Side {
    double slowest = 1, fastest = 1;  ///< speed at the apex over the slowest and the fastest
    /// The flattest ray that tubes send there.
    SnellRay flattest;
    /// Where it is at the borders of layers, from the apex on.
    struct Border {
      double way_m, speed_m_s, gradient_per_s, sine, range_m;
    };
    std::vector<Border> borders;
    /// No ray of the tubes is farther where it has risen or fallen all the `way_m`.
    double farthest_m(double way_m) const;
  };
  void trace_flattest(Side& side, bool down, double launch_sine);
  /// Points between heights above the apex, in the convex hull of places in plan from it, the nearest point
  /// of that known; 0 where it holds the apex.
  bool may_see(std::span<const glm::dvec2> ways_m, glm::dvec2 nearest_m, double lowest_m,
               double highest_m) const;
  /// Points in a range of heights above the apex and of distances from its vertical, in the azimuths of
  /// `box`, whose elevations are set.
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
