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

/// A convex visible polygon of the seabed, where it lies.
struct VisiblePolygon {
  FacetId facet = 0;
  glm::dvec3 normal{0, 0, 1};  ///< unit, towards the side that is seen
  double distance_m = 0;       ///< of the origin from the plane, positive on that side
  std::uint32_t first_corner = 0, corner_count = 0;
  std::uint32_t tx_tube = 0, rx_tube = 0;
};

/// What one or several signals come from: polygons with disjoint interiors.
struct VisiblePolygons {
  glm::dvec3 origin_m{0};  ///< local frame; corners are relative to it
  std::vector<VisiblePolygon> patches;
  std::vector<glm::dvec3> corners_m;

  std::span<const glm::dvec3> corners(const VisiblePolygon& patch) const {
    return std::span(corners_m).subspan(patch.first_corner, patch.corner_count);
  }
  double area_m2() const;
};

/// All that a common visibility has; its origin is the apex of the law's way out. Ways over mirrors come from
/// for_coherent_paths() (engine/paths/coherent_paths.hpp), whose channels are images, too. Throws
/// std::invalid_argument for a seabed that is seen elsewhere than it lies (refracting water), for ways over
/// mirrors, and for what rays met: none of them has polygons whose points have straight ways to any channel.
VisiblePolygons visible_polygons(const CommonVisibility& visibility, const EchoModel& model);

/// Patches of smooth facets and those of rough ones, which return signals of their own.
struct SplitPolygons {
  VisiblePolygons smooth, rough;
};
/// Each patch goes to one of both, in the order in which they are.
SplitPolygons split_polygons(const VisiblePolygons& patches, const std::function<bool(FacetId)>& is_smooth);

/// The same of what an apex or its image sees together with another's, both in isovelocity water: what
/// channels make of it has to be told by their images over the same mirrors. `tx_m`: of the transmit leg.
VisiblePolygons patches_between(const BistaticHistory& images, glm::dvec3 tx_m);

/// What two sights share: the intersections of their polygons on each facet, in doubles. Origin and tubes are
/// those of the first one. Facets have the same numbers in both.
VisiblePolygons common_patches(const VisiblePolygons& first, const VisiblePolygons& second);

}  // namespace tubefoot
