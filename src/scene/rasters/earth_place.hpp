// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/mat3x3.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "scene/rasters/georeference.hpp"

namespace tubefoot {

/// A local point on Earth, and the orientation of its frame's axes there.
struct EarthPlace {
  glm::dvec3 lon_lat_height{0};  ///< as LocalFrame::to_lon_lat()
  /// Maps a local vector to true east, true north and up, from which headings count. In a tangent frame it
  /// is a rotation, because the axes of the frame deviate from the Earth's with the distance from the
  /// origin.
  /// In a projected frame it is the derivative of the map at the point, in metres on the ellipsoid per
  /// metre of the map. There meridians converge, and lengths (on maps that are not conformal also angles)
  /// differ from those on Earth. Up is unchanged.
  glm::dmat3 to_east_north_up{1};

  /// Returns a local unit vector as a unit vector on Earth, with the same elevation on any map.
  glm::dvec3 direction(glm::dvec3 local) const;
};

/// Returns the places of points with one transformation for all. Throws InputError at `place` where
/// LocalFrame::to_lon_lat() does, also for positions 100 m around the points.
std::vector<EarthPlace> on_earth(const LocalFrame& frame, std::span<const glm::dvec3> points,
                                 const SourcePlace& place);

/// Returns a warning for a frame whose map changes lengths at its origin by more than a hundredth. A sonar
/// there would receive echoes of a world that is too large or too small.
std::optional<std::string> scale_warning(const LocalFrame& frame);

/// Returns the displacement between two places (longitude, latitude, height). East and north are the length
/// of the geodesic on the ellipsoid [m] in its initial direction; up is the difference of heights.
/// A reader that moves so far along a heading and to starboard arrives at the second place, whatever the
/// map is.
glm::dvec3 east_north_up_between(glm::dvec3 from_lon_lat_height, glm::dvec3 to_lon_lat_height);

}  // namespace tubefoot
