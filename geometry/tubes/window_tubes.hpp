// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <span>
#include <unordered_map>
#include <vector>

#include "geometry/tubes/tube.hpp"

namespace tubefoot {

/// Represents convex cones of directions as tubes of four rays each. Corners are rounded to integer rays of
/// length 2^29 (2e-9 rad). Equal corners share their ray, so cones with common corners still form a
/// partition. A cone of three corners becomes a tube whose fourth ray is the sum of two of its rays. This ray
/// lies exactly in the wall of the two.
///
/// Law B4 (windows): the tubes of a cone form the cone, without gaps or overlaps.
class WindowTubes {
 public:
  /// `reach` is the value of TubeSet::reach.
  WindowTubes(GridPoint apex, double reach);

  /// Adds a cone by the directions of its corners (of any length except 0). They are counter-clockwise for an
  /// observer who looks back at the apex, as those of all tubes. Each of its tubes gets `label`. Corners that
  /// lie on the line of their neighbours or beyond it after rounding are omitted. Cones with fewer than three
  /// remaining corners are omitted.
  void add(std::span<const glm::dvec3> corners, std::uint32_t label);

  const TubeSet& tubes() const { return set_; }
  /// Returns, per tube, the label of its cone.
  const std::vector<std::uint32_t>& labels() const { return labels_; }
  /// Returns, per tube and ray, the number of the corner in its cone. The third ray of a triangle, which is a
  /// sum of two others, has the number of the second ray.
  const std::vector<std::array<std::uint32_t, 4>>& corner_numbers() const { return numbers_; }

 private:
  std::uint32_t ray(GridPoint direction);

  TubeSet set_;
  std::vector<std::uint32_t> labels_;
  std::unordered_map<GridPoint, std::uint32_t, GridPointHash> rays_;
  std::vector<std::array<std::uint32_t, 4>> numbers_;
  std::vector<GridPoint> corners_;
  std::vector<std::uint32_t> kept_;
};

/// Returns whether a direction lies in a tube, on its walls, or at most `slack_rad` beyond one. Exact without
/// slack, for |coordinates| <= 2^31.
bool holds(const TubeSet& set, std::uint32_t tube, GridPoint direction, double slack_rad = 0);

}  // namespace tubefoot
