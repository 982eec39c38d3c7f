// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "engine/scattering/facet_map.hpp"
#include "engine/scattering/reflectivity_field.hpp"

namespace tubefoot {

/// Cuts polygons along the planes on which a texture is not analytic, so that Gauss rules converge in each
/// part. Neighbouring parts have the same corners except for rounding. Contains scratch memory: use one
/// object per thread.
class TextureCells {
 public:
  /// Calls `take` for each part of a convex polygon on a facet that lies in one cell. A polygon within one
  /// cell, or without texture (null), is passed unchanged. The time is proportional to the number of cells
  /// that the polygon meets, and the memory to its corners.
  void cut(const PlanarPolygon& polygon, const LyingPlane& plane, const ReflectivityField* texture,
           const std::function<void(const PlanarPolygon&)>& take);

 private:
  struct Level {
    PlanarPolygon rest, part, next;
  };
  void cut(std::span<const CellPlanes> cells, const PlanarPolygon& polygon, std::size_t level);

  LyingPlane plane_;
  const std::function<void(const PlanarPolygon&)>* take_ = nullptr;
  std::vector<Level> levels_;  // per family of planes
  PlanarPolygon taken_;
};

}  // namespace tubefoot
