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

/// Properties of a scene that its tracks depend on.
struct TrackSurroundings {
  LocalFrame frame{};
  double surface_height_m = 0;  ///< height of the water surface
  /// Returns the heights of the terrain at positions east and north, in their order; empty where there is
  /// no terrain.
  std::function<std::vector<std::optional<double>>(std::span<const glm::dvec2>)> terrain_heights_m{};
  /// If given, receives warnings about tracks. Examples are headings that fit the track as radians and not
  /// as degrees, implausible speeds, and ignored columns.
  std::vector<std::string>* odd = nullptr;

  /// Transform points to the local frame; heights are local and stay. The input is longitude and latitude
  /// in degrees, or easting and northing in the scene's CRS. Throw InputError at `place`.
  /// @{
  void place_by_lon_lat(std::span<glm::dvec3> points, const SourcePlace& place) const;
  void place_by_crs(std::span<glm::dvec3> points, const SourcePlace& place) const;
  /// @}
};

/// Survey lines in sequence, with turns between them. Before and after a line, the carrier continues
/// straight for half of the turn. This models a carrier that turns outside of the area. Later transmissions
/// of a ping at the end of a line take place there.
class SurveyLines {
 public:
  /// Throws std::invalid_argument for a turn without duration.
  explicit SurveyLines(double turn_s);
  /// Adds a line with at least two samples. The first sample has the time 0.
  void add(std::vector<Trajectory::Sample> line);
  Trajectory finish() &&;

 private:
  double turn_s_;
  std::vector<Trajectory::Sample> samples_;
  std::vector<Trajectory::Line> lines_;
};

}  // namespace tubefoot
