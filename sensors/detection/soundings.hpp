// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/vec3.hpp>
#include <string>

#include "scene/rasters/georeference.hpp"
#include "sensors/detection/bottom_detection.hpp"
#include "sensors/detection/cell_means.hpp"
#include "sensors/pictures/canvas.hpp"

namespace tubefoot {

/// A place of the bed that a beam found.
struct Sounding {
  std::uint32_t ping = 0, beam = 0;  ///< counted from 0
  double time_s = 0;                 ///< of the transmission, on the scene's clock
  glm::dvec3 position_m{0};          ///< east, north, up in the local frame
  double two_way_travel_time_s = 0;
  double slant_range_m = 0;
  double beam_angle_deg = 0;  ///< of the beam's axis from straight down of the sensor, starboard positive
  double amplitude = 0;       ///< of the sample that was picked, as the time series has it
  double quality = 0;         ///< 0 to 1, of the detector
  DetectionMethod method = DetectionMethod::maximum;
  DetectionFlags flags;  ///< what makes it doubtful
};

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
  /// A picture to look at: shaded relief lit from the north-west, coloured by depth, with axes, scale and
  /// legend. Throws std::runtime_error without soundings.
  Canvas draw(const std::string& title, const std::string& font) const;

 private:
  void add(glm::dvec3 position_m, double weight);

  LocalFrame frame_;
  CellMeans depths_;
};

}  // namespace tubefoot
