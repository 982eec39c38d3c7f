// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <vector>

#include "geometry/search/scene_tree.hpp"
#include "geometry/tubes/tube.hpp"

namespace tubefoot {

/// The pyramid of one tube, in doubles: for what is looked at, not for what is seen.
class TubePyramid {
 public:
  TubePyramid(const TubeSet& tubes, std::size_t tube);

  /// Its walls, for SceneTree::query().
  const std::array<SceneTree::HalfSpace, 4>& walls() const { return walls_; }
  /// Whether a box may meet it.
  bool may_meet(const GridPoint& lowest, const GridPoint& highest) const;
  /// The part of a facet inside it, whatever hides it: corners from the apex, in grid units; of fewer than
  /// three, nothing. Good until the next call.
  const std::vector<glm::dvec3>& part_of(const FacetMesh& mesh, FacetId facet);

 private:
  GridPoint apex_;
  glm::dvec3 ahead_;
  std::array<glm::dvec3, 4> inward_;
  std::array<SceneTree::HalfSpace, 4> walls_;
  std::vector<glm::dvec3> polygon_, scratch_;
};

}  // namespace tubefoot
