// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "geometry/mesh/facet_cone.hpp"
#include "geometry/tubes/tube.hpp"

namespace tubefoot {

/// The walls of tubes, for the exact decision which tubes contain a point.
///
/// Law X1 (one tube): tubes that partition a sector contain each point of the sector exactly once. This holds
/// for points on walls and on common rays, too. A point on a wall counts as displaced by an infinitesimal
/// step to the east. If this step lies in the wall, a step to the north decides, and then one upwards.
class TubeWalls {
 public:
  explicit TubeWalls(const TubeSet& tubes);

  std::size_t size() const { return walls_.size(); }
  GridPoint apex() const { return apex_; }
  /// Returns whether a tube contains a point. The apex itself lies in no tube.
  bool contains(std::uint32_t tube, GridPoint point) const;
  /// Replaces `tubes` by the tubes that contain a point, in ascending order.
  void find(GridPoint point, std::vector<std::uint32_t>& tubes) const;
  /// Returns the inward normals of a tube, not normalised; 0 for a wall whose corner rays coincide.
  const std::array<Vec64, 4>& normals(std::uint32_t tube) const { return walls_[tube]; }

 private:
  GridPoint apex_;
  std::vector<std::array<Vec64, 4>> walls_;
};

}  // namespace tubefoot
