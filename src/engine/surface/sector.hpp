// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <utility>
#include <vector>

#include "geometry/search/scene_tree.hpp"
#include "geometry/tubes/tube.hpp"

// Bounds the directions and the reach of a set of tubes by a few convex pyramids. Tests of points, boxes of
// directions and facets against the pyramids are conservative: they return false only if no tube can meet
// them.
namespace tubefoot {

/// Directions within a range of azimuths and a range of elevations.
struct DirectionBox {
  /// Horizontal unit vectors, less than half a turn apart. Azimuths lie between them, counter-clockwise from
  /// the first to the second.
  glm::dvec2 from{1, 0}, to{1, 0};
  bool all_round = false;  ///< all azimuths, whatever the values of `from` and `to`
  /// Sines and cosines of the elevation limits.
  double low_sine = 0, low_cosine = 1, high_sine = 0, high_cosine = 1;
  /// Returns the largest n . u over the directions u of the box.
  double farthest_along(const glm::dvec3& n) const;
};

/// Directions and reach of a set of tubes, enclosed in a few convex pyramids. The class answers quickly and
/// conservatively whether a transmission may see something.
class Sector {
 public:
  Sector(const TubeSet& tubes, double grid_unit_m);

  /// Returns false only if no tube comes within `radius_m` of a position relative to the apex, in metres. If
  /// the result is true for a ball, it is true for every ball that contains it.
  bool may_meet(glm::dvec3 place_m, double radius_m) const;

  /// Returns the facets of a tree that tubes may meet when the facets are displaced by up to `margin_m`, by
  /// increasing id.
  std::vector<FacetId> facets(const SceneTree& tree, double margin_m) const;

  /// Returns false only if no tube contains a direction of the box.
  bool may_meet(const DirectionBox& box) const;
  /// Returns the sines of the lowest and the highest elevation of all tubes.
  std::pair<double, double> elevation_sines() const;
  double reach_m() const { return reach_ * unit_m_; }

  /// Returns the angle between the rays of the narrowest side of a tube.
  double narrowest_rad() const { return narrowest_rad_; }

 private:
  struct Pyramid {
    glm::dvec3 axis;
    double spread_rad;                 ///< largest angle of a ray to the axis
    std::vector<glm::dvec3> inward;    ///< unit normals of the sides, which point inwards
    double lowest_sine, highest_sine;  ///< bounds of the elevations
  };
  void add(const TubeSet& tubes, std::size_t first, std::size_t end);

  GridPoint apex_;
  double unit_m_, reach_, narrowest_rad_;
  std::vector<Pyramid> pyramids_;
};

}  // namespace tubefoot
