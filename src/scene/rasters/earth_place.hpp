// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/mat3x3.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "scene/rasters/georeference.hpp"

namespace tubefoot {

/// A local point on Earth, and how the axes of its frame lie there.
struct EarthPlace {
  glm::dvec3 lon_lat_height{0};  ///< as LocalFrame::to_lon_lat
  /// Turns a local vector into one to the true east, to the true north and up, which is where headings count
  /// from. In a tangent frame a rotation: its axes lean away from the Earth's with the distance from the
  /// origin. In a projected one the derivative of its map at the point, in metres on the ellipsoid per metre
  /// of the map: meridians converge on it, and lengths (and, on maps that are not conformal, angles) are not
  /// the Earth's. Up is up.
  glm::dmat3 to_east_north_up{1};

  /// A local direction (of length 1) as one of length 1 on Earth: as far above the horizon on any map.
  glm::dvec3 direction(glm::dvec3 local) const;
};

/// Of each point, with one transformation set up for all. Throws InputError at `place` where
/// LocalFrame::to_lon_lat does, also for points 100 m around those that are given.
std::vector<EarthPlace> on_earth(const LocalFrame& frame, std::span<const glm::dvec3> points,
                                 const SourcePlace& place);

/// What to say of a frame whose map draws a metre at its origin more than a hundredth longer or shorter than
/// it is: all that a sonar receives there is of a world too large or too small.
std::optional<std::string> scale_warning(const LocalFrame& frame);

/// The way from one place (longitude, latitude, height) to another: along the shortest line on the ellipsoid
/// [m], as far to the east and north as the direction in which it leaves says; and the difference of heights.
/// A reader that goes so far along a heading and to its starboard arrives where it should, whatever the map.
glm::dvec3 east_north_up_between(glm::dvec3 from_lon_lat_height, glm::dvec3 to_lon_lat_height);

}  // namespace tubefoot
