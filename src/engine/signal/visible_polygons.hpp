// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "engine/scattering/echo_model.hpp"
#include "engine/visibility/common_visibility.hpp"

namespace tubefoot {

/// Convex visible polygon of the seabed, at its true position.
struct VisiblePolygon {
  FacetId facet = 0;
  glm::dvec3 normal{0, 0, 1};  ///< unit vector towards the visible side
  double distance_m = 0;       ///< of the origin from the plane, positive on that side
  std::uint32_t first_corner = 0, corner_count = 0;
  std::uint32_t tx_tube = 0, rx_tube = 0;
  std::uint32_t piece = 0;  ///< number in the history
};

/// Visible polygons that return signals, with disjoint interiors.
struct VisiblePolygons {
  glm::dvec3 origin_m{0};  ///< local frame; corners are relative to it
  std::vector<VisiblePolygon> patches;
  std::vector<glm::dvec3> corners_m;

  std::span<const glm::dvec3> corners(const VisiblePolygon& patch) const {
    return std::span(corners_m).subspan(patch.first_corner, patch.corner_count);
  }
  double area_m2() const;
};

/// Polygons of a common visibility. The origin is the apex of the model's transmit leg. For paths over
/// mirrors use for_coherent_paths() (engine/paths/coherent_paths.hpp), whose channels are images. Throws
/// std::invalid_argument in refracting water, for paths over mirrors, and for hits of rays. These have no
/// polygons with straight paths to any channel.
VisiblePolygons visible_polygons(const CommonVisibility& visibility, const EchoModel& model);

/// Polygons of smooth facets and of rough facets, whose signals are computed separately.
struct SplitPolygons {
  VisiblePolygons smooth, rough;
};
/// Distributes the polygons to both sets in their given order.
SplitPolygons split_polygons(const VisiblePolygons& patches, const std::function<bool(FacetId)>& is_smooth);

/// Polygons that two apexes or images both see in isovelocity water. The channels must be images over the
/// same mirrors. `tx_m`: apex of the transmit leg.
VisiblePolygons patches_between(const BistaticHistory& images, glm::dvec3 tx_m);

/// Intersections of the polygons of two visibilities on each facet, in doubles. Origin and tubes are those
/// of the first. Facet numbers must be the same in both.
VisiblePolygons common_patches(const VisiblePolygons& first, const VisiblePolygons& second);

}  // namespace tubefoot
