// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <utility>
#include <vector>

#include "geometry/search/scene_tree.hpp"
#include "geometry/tubes/tube.hpp"

namespace tubefoot {

/// Directions of a range of azimuths and a range of elevations.
struct DirectionBox {
  /// Horizontal unit vectors, less than half a turn apart: azimuths lie between them, counter-clockwise from
  /// the first to the second.
  glm::dvec2 from{1, 0}, to{1, 0};
  bool all_round = false;  ///< all azimuths, whatever `from` and `to` are
  double low_sine = 0, low_cosine = 1, high_sine = 0, high_cosine = 1;  ///< of the elevations' ends
  /// The largest n . u of directions u of the box.
  double farthest_along(const glm::dvec3& n) const;
};

/// The directions of a set of tubes and how far they reach, as a few convex pyramids that hold them all: a
/// quick and safe answer to whether a transmission may look at something.
class Sector {
 public:
  Sector(const TubeSet& tubes, double grid_unit_m);

  /// False only if no tube comes within `radius_m` of a place relative to the apex, metres. What is true for
  /// a ball is true for every ball that holds it.
  bool may_meet(glm::dvec3 place_m, double radius_m) const;

  /// Facets of a tree that may be looked at when they are moved by up to `margin_m`; by increasing id.
  std::vector<FacetId> facets(const SceneTree& tree, double margin_m) const;

  /// False only if no tube looks in a direction of the box.
  bool may_meet(const DirectionBox& box) const;
  /// Sines of the elevations between which all tubes look.
  std::pair<double, double> elevation_sines() const;
  double reach_m() const { return reach_ * unit_m_; }

  /// Angle between the rays of the narrowest side of a tube.
  double narrowest_rad() const { return narrowest_rad_; }

 private:
  struct Pyramid {
    glm::dvec3 axis;
    double spread_rad;                 ///< no ray is farther from the axis
    std::vector<glm::dvec3> inward;    ///< unit normals of its sides
    double lowest_sine, highest_sine;  ///< elevations of its directions lie between
  };
  void add(const TubeSet& tubes, std::size_t first, std::size_t end);

  GridPoint apex_;
  double unit_m_, reach_, narrowest_rad_;
  std::vector<Pyramid> pyramids_;
};

}  // namespace tubefoot
