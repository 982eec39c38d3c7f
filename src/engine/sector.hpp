// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "geometry/scene_tree.hpp"
#include "geometry/tube.hpp"

namespace tubefoot {

/// The directions of a set of tubes and how far they reach, as a few convex pyramids that hold them all: a
/// quick and safe answer to whether a shot may look at something.
class Sector {
 public:
  Sector(const TubeSet& tubes, double grid_unit_m);

  /// False only if no tube comes within `radius_m` of a place relative to the apex, metres. What is true for
  /// a ball is true for every ball that holds it.
  bool may_meet(glm::dvec3 place_m, double radius_m) const;

  /// Facets of a tree that may be looked at when they are moved by up to `margin_m`; by increasing id.
  std::vector<FacetId> facets(const SceneTree& tree, double margin_m) const;

  /// As may_meet(), for a ball whose points are seen, each in its own vertical plane, up to `turn_rad` higher
  /// or lower than they are, and at `stretch` times their distance or more.
  bool may_meet_turned(glm::dvec3 place_m, double radius_m, double turn_rad, double stretch) const;
  /// As facets(), for facets whose points are seen so.
  std::vector<FacetId> facets_turned(const SceneTree& tree, double turn_rad, double stretch,
                                     double margin_m = 0) const;

  /// Angle between the rays of the narrowest side of a tube.
  double narrowest_rad() const { return narrowest_rad_; }

 private:
  struct Pyramid {
    glm::dvec3 axis;
    double spread_rad;               ///< no ray is farther from the axis
    std::vector<glm::dvec3> inward;  ///< unit normals of its sides
    std::vector<glm::dvec3> rays;
  };
  void add(const TubeSet& tubes, std::size_t first, std::size_t end);

  GridPoint apex_;
  double unit_m_, reach_, narrowest_rad_;
  std::vector<Pyramid> pyramids_;
};

}  // namespace tubefoot
