// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <unordered_map>
#include <vector>

#include "geometry/tubes/tube.hpp"

namespace tubefoot {

/// Convex cones of directions as tubes of four rays each. Corners are rounded to integer rays of 2^29
/// (2e-9 rad) and equal corners share their ray, so cones with common corners still partition what they did.
/// A cone of three corners becomes a tube whose fourth ray is the sum of two of its rays: it lies in the wall
/// of the two, exactly.
/// Law B4 (windows): a fan of cones is their union, without gaps or overlaps.
class WindowTubes {
 public:
  /// `reach`: TubeSet::reach.
  WindowTubes(GridPoint apex, double reach);

  /// Adds a cone by its corners' directions (of any length, not 0), counter-clockwise for someone who looks
  /// back at the apex as those of all tubes; `label` is kept for each of its tubes. Corners that rounding
  /// puts on the line of their neighbours, or beyond it, are left out; so are cones of which less than three
  /// are left.
  void add(std::span<const glm::dvec3> corners, std::uint32_t label);

  const TubeSet& tubes() const { return set_; }
  /// By tube: the label of its cone.
  const std::vector<std::uint32_t>& labels() const { return labels_; }

 private:
  std::uint32_t ray(GridPoint direction);

  TubeSet set_;
  std::vector<std::uint32_t> labels_;
  std::unordered_map<GridPoint, std::uint32_t, GridPointHash> rays_;
  std::vector<GridPoint> corners_;
};

/// Whether a direction lies in a tube, on its walls, or no more than `slack_rad` beyond one. Without slack
/// exact, for |coordinates| <= 2^31.
bool holds(const TubeSet& set, std::uint32_t tube, GridPoint direction, double slack_rad = 0);

}  // namespace tubefoot
