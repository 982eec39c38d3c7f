// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <vector>

#include "geometry/search/scene_tree.hpp"
#include "geometry/tubes/tube.hpp"

namespace tubefoot {

/// The pyramid of one tube in floating-point arithmetic. It serves to select facets, not to compute
/// visibility.
class TubePyramid {
 public:
  TubePyramid(const TubeSet& tubes, std::size_t tube);

  /// Returns the side planes for SceneTree::query().
  const std::array<SceneTree::HalfSpace, 4>& walls() const { return walls_; }
  /// Returns whether a box may meet the pyramid.
  bool may_meet(const GridPoint& lowest, const GridPoint& highest) const;
  /// Returns the part of a facet inside the pyramid, regardless of visibility: corners relative to the apex,
  /// in grid units. Fewer than three corners mean that no part is inside. The result is valid until the next
  /// call.
  const std::vector<glm::dvec3>& part_of(const FacetMesh& mesh, FacetId facet);

 private:
  GridPoint apex_;
  glm::dvec3 ahead_;
  std::array<glm::dvec3, 4> inward_;
  std::array<SceneTree::HalfSpace, 4> walls_;
  std::vector<glm::dvec3> polygon_, scratch_;
};

}  // namespace tubefoot
