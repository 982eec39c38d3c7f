// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <glm/vec2.hpp>
#include <optional>
#include <span>
#include <vector>

#include "scene/rasters/georeference.hpp"
#include "scene/trajectory.hpp"
#include "sensors/detection/cell_means.hpp"

namespace tubefoot {

/// What a sidescan heard of one ping.
struct SidescanPing {
  Pose pose;                               ///< of the sensor in the local frame
  double altitude_m = 0;                   ///< height of the sensor above the bed below it
  double first_m = 0;                      ///< slant range at which sample 0 begins
  double step_m = 0;                       ///< slant range of one sample
  std::span<const float> port, starboard;  ///< NaN: no value
};

/// A map of sidescan pings, corrected for slant range as if the bed were flat: what came back from the slant
/// range r lies sqrt(r^2 - altitude^2) from the track, at right angles to the heading; what came before the
/// altitude is water and left out. Attitude beyond the heading is not corrected for.
///
/// Each sample fills, by area, the strip of the bed between the ground ranges at which it begins and ends and
/// half the way to the pings before and after; a cell is the mean of the samples over it, weighted by area
/// (sampled no coarser than a third of a cell). Pings are taken one by one; memory is that of CellMeans and
/// the ping before.
class SidescanMosaic {
 public:
  /// Throws std::invalid_argument for a cell that is not positive.
  explicit SidescanMosaic(double cell_m, std::size_t most_bytes = CellMeans::default_most_bytes);

  /// Throws std::invalid_argument for a ping that makes no sense (ranges, altitude, a sensor on its side),
  /// std::runtime_error where the mosaic would need more memory than most_bytes, and says what to do.
  void add(const SidescanPing& ping);
  /// The next ping begins another line: nothing is filled between it and the ones before.
  void end_line() { before_.reset(); }

  const CellMeans& cells() const { return cells_; }
  /// Float32 GeoTIFF, band "Backscatter" with `unit` (write_cells).
  void write_tiff(const std::filesystem::path& file, const LocalFrame& frame, const char* unit) const {
    write_cells(file, cells_, frame, "Backscatter", unit);
  }

 private:
  struct Line {
    glm::dvec2 track, starboard;  ///< east, north; starboard of unit length
    double altitude_m, first_m, step_m;
    std::vector<float> port, starboard_samples;
  };
  void fill_side(const Line& line, double side, const std::vector<float>& samples, const Line& other,
                 double way);

  CellMeans cells_;
  std::optional<Line> before_;
};

}  // namespace tubefoot
