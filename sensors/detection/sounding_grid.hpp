// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <glm/vec3.hpp>

#include "scene/rasters/georeference.hpp"
#include "sensors/detection/cell_means.hpp"
#include "sensors/detection/sounding.hpp"

namespace tubefoot {

/// Mean depth of soundings per cell. Depths are positive down from height 0: minus up, minus the height of
/// the frame's origin. (In a tangent frame, below the plane at height 0: the ellipsoid falls away from it by
/// d^2 / 2R, 8 cm at 1 km.)
class SoundingGrid {
 public:
  /// Throws std::invalid_argument for a cell that is not positive.
  SoundingGrid(LocalFrame frame, double cell_m);
  /// Soundings that are not finite, or of echoes that the window cuts, are left out. Throws
  /// std::runtime_error where the grid would become too large for memory.
  void add(const Sounding& sounding);
  /// Fills cells without soundings of their own on the straight line between two; where there are some, they
  /// outweigh this by 10^9. Nothing where one is left out by add().
  void add_between(const Sounding& from, const Sounding& to);

  const CellMeans& depths() const { return depths_; }
  /// Float32 GeoTIFF, band "Depth" in metres (write_cells). Throws std::runtime_error, also without
  /// soundings.
  void write_tiff(const std::filesystem::path& file) const;

 private:
  void add(glm::dvec3 position_m, double weight);

  LocalFrame frame_;
  CellMeans depths_;
};

}  // namespace tubefoot
