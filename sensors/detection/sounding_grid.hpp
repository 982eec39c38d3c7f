// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <glm/vec3.hpp>

#include "scene/rasters/georeference.hpp"
#include "sensors/detection/cell_means.hpp"
#include "sensors/detection/sounding.hpp"

namespace tubefoot {

/// A sounding, and the place of the sonar that measured it.
struct MeasuredFrom {
  const Sounding& sounding;
  glm::dvec3 sonar_m;
};

/// Returns whether the line between two neighbouring soundings may fill the cells between them. Neighbours
/// are of adjacent beams or of consecutive pings. On a level seabed, their horizontal distance follows from
/// the angle between their directions and from the movement of the sonar. A distance of more than twice this
/// value shows that a part of the seabed between them lies in an acoustic shadow. Distances of up to two
/// cells are always filled.
bool fills_between(const MeasuredFrom& a, const MeasuredFrom& b, double cell_m);

/// Mean depth of soundings per cell. Depths are positive down from height 0: minus up, minus the height of
/// the frame's origin. In a tangent frame they count from the plane at height 0. The ellipsoid falls away
/// from it by d^2 / 2R, 8 cm at 1 km.
class SoundingGrid {
 public:
  /// Throws std::invalid_argument if the cell size is not positive.
  SoundingGrid(LocalFrame frame, double cell_m);
  /// Adds a sounding. Soundings that are not finite, or whose echo the range gate cuts, are omitted. Throws
  /// std::runtime_error if the grid becomes too large for memory.
  void add(const Sounding& sounding);
  /// Fills cells without soundings on the straight line between two soundings. Soundings of a cell outweigh
  /// this value by 10^9. Does nothing if add() omits one of the two.
  void add_between(const Sounding& from, const Sounding& to);

  const CellMeans& depths() const { return depths_; }
  /// Writes a Float32 GeoTIFF with the band "Depth" in metres (write_cells). Throws std::runtime_error, also
  /// if there are no soundings.
  void write_tiff(const std::filesystem::path& file) const;

 private:
  void add(glm::dvec3 position_m, double weight);

  LocalFrame frame_;
  CellMeans depths_;
};

}  // namespace tubefoot
