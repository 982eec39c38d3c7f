// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <glm/vec2.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "files/input_error.hpp"
#include "scene/rasters/georeference.hpp"
#include "scene/trajectory.hpp"

namespace tubefoot {

/// What tracks need of the scene that they go through.
struct TrackSurroundings {
  LocalFrame frame{};
  double surface_height_m = 0;  ///< of the water
  /// Heights of the terrain at places east and north, in their order; nothing where there is none.
  std::function<std::vector<std::optional<double>>(std::span<const glm::dvec2>)> terrain_heights_m{};
  /// If given, receives what is odd about tracks: headings that fit their way as radians and not as degrees,
  /// speeds that no carrier has, columns that are ignored.
  std::vector<std::string>* odd = nullptr;

  /// Puts points where they lie in the local frame; heights are local and stay. Given by longitude and
  /// latitude in degrees, or by easting and northing of the scene's CRS. Throws InputError at `place`.
  /// @{
  void place_by_lon_lat(std::span<glm::dvec3> points, const SourcePlace& place) const;
  void place_by_crs(std::span<glm::dvec3> points, const SourcePlace& place) const;
  /// @}
};

/// Lines one after the other, and turns between them. Before and behind a line the carrier goes straight on
/// for half a turn, as those do that turn outside of the area: what a ping at its end fires later is fired
/// there.
class SurveyLines {
 public:
  /// Throws std::invalid_argument for a turn that takes no time.
  explicit SurveyLines(double turn_s);
  /// At least two samples, of which the first is at time 0.
  void add(std::vector<Trajectory::Sample> line);
  Trajectory finish() &&;

 private:
  double turn_s_;
  std::vector<Trajectory::Sample> samples_;
  std::vector<Trajectory::Line> lines_;
};

}  // namespace tubefoot
