// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <ogr_geometry.h>

#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <vector>

#include "geometry/footprints/footprint.hpp"

namespace tubefoot {

/// Coordinate reference system of the local frame: east and north in metres from the scene's origin.
/// Heights are metres above the origin.
constexpr const char* local_crs =
    R"wkt(ENGCRS["tubefoot local east-north",EDATUM["scene origin"],CS[Cartesian,2],)wkt"
    R"wkt(AXIS["east (E)",east,ORDER[1],LENGTHUNIT["metre",1]],)wkt"
    R"wkt(AXIS["north (N)",north,ORDER[2],LENGTHUNIT["metre",1]]])wkt";

/// A part of a facet for geographic programs: a valid OGC simple feature in plan view. A part without plan
/// area (of a wall) cannot be a valid polygon, so that lines around it represent it.
struct PlanShape {
  using Line = std::vector<glm::dvec3>;     ///< a ring repeats its first corner at its end
  std::vector<std::vector<Line>> polygons;  ///< each with an outer ring and its holes
  std::vector<Line> outlines;               ///< closed lines; only if there is no polygon
  bool is_upright() const { return polygons.empty(); }

  std::unique_ptr<OGRMultiPolygon> multi_polygon() const;
  std::unique_ptr<OGRMultiLineString> multi_line() const;
};

/// Computes the union of convex pieces of a facet, without their common borders. `on_map` has the corners
/// in output coordinates. `corners_m` has the same corners in metres and decides whether there is plan
/// area: a shape narrower than 10 nm has none.
/// All corners of the result are elements of `on_map`, with one exception. Rounding to map coordinates can
/// make a thin shape an invalid feature. GEOS then repairs the shape and adds crossings.
PlanShape plan_shape(std::span<const glm::dvec3> corners_m, std::span<const glm::dvec3> on_map,
                     std::span<const Piece> pieces);

}  // namespace tubefoot
