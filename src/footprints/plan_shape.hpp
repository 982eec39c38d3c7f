// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <ogr_geometry.h>

#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <vector>

#include "geometry/footprints/footprint.hpp"

namespace tubefoot {

/// A part of a facet as geographic programs take it: a valid OGC simple feature, whose validity is one of the
/// plan. What has no plan area (a wall) cannot be a polygon there: it is the lines round it.
struct PlanShape {
  using Line = std::vector<glm::dvec3>;     ///< a ring repeats its first corner at its end
  std::vector<std::vector<Line>> polygons;  ///< each an outer ring and its holes
  std::vector<Line> outlines;               ///< closed; only where there is no polygon
  bool is_upright() const { return polygons.empty(); }

  std::unique_ptr<OGRMultiPolygon> multi_polygon() const;
  std::unique_ptr<OGRMultiLineString> multi_line() const;
};

/// The union of convex pieces of a facet, without the borders that they share. `on_map` has the corners as
/// they are written; `corners_m` the same in metres, which tell whether there is plan area: a shape of less
/// than 10 nm of width has none. All corners of the result are those of `on_map`, but where what rounding to
/// map coordinates made of thin shapes is no simple feature: GEOS mends these, which adds crossings.
PlanShape plan_shape(std::span<const glm::dvec3> corners_m, std::span<const glm::dvec3> on_map,
                     std::span<const Piece> pieces);

}  // namespace tubefoot
