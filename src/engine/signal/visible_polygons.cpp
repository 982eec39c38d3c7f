// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/signal/visible_polygons.hpp"

#include <algorithm>
#include <glm/geometric.hpp>
#include <numeric>
#include <stdexcept>

#include "geometry/integrals/convex_clip.hpp"
#include "geometry/integrals/measure.hpp"
#include "geometry/steps/stop.hpp"

// Collects the visible polygons of footprints, and intersects the polygons of two visibilities on each facet
// in doubles. Polygons are in the local frame relative to an origin.

namespace tubefoot {
namespace {

/// Whether the bounding boxes of two polygons are disjoint, which is the most frequent case for polygons of
/// one facet.
bool apart(std::span<const glm::dvec3> a, std::span<const glm::dvec3> b, glm::dvec3 b_further) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto ends = [axis](std::span<const glm::dvec3> corners) {
      double lo = corners[0][axis], hi = lo;
      for (const glm::dvec3& c : corners) {
        lo = std::min(lo, c[axis]);
        hi = std::max(hi, c[axis]);
      }
      return std::pair(lo, hi);
    };
    const auto [a_lo, a_hi] = ends(a);
    const auto [b_lo, b_hi] = ends(b);
    if (a_hi < b_lo + b_further[axis] || b_hi + b_further[axis] < a_lo) return true;
  }
  return false;
}

VisiblePolygons patches_of(const CommonVisibility& visibility, glm::dvec3 origin_m) {
  if (!visibility.hits().empty() || !visibility.shared_hits().empty())
    throw std::invalid_argument("signals need visible polygons, but the hits of rays are points");
  VisiblePolygons seen;
  seen.origin_m = origin_m;
  for (std::size_t number = visibility.first(); number < visibility.end(); ++number) {
    if (visibility.bistatic(number) != nullptr)
      throw std::invalid_argument(
          "signals need a surface that both ends see at its true position, without refraction");
    const SeenFacet facet = visibility[number];
    for (std::uint32_t k = 0; k < facet.piece_count; ++k) {
      const SeenPart part = visibility.part(number, facet.first_piece + k);
      if (part.corners_m.size() < 3) continue;
      seen.patches.push_back({facet.facet, facet.plane.normal, facet.plane.distance_m,
                              std::uint32_t(seen.corners_m.size()), std::uint32_t(part.corners_m.size()),
                              part.tx_tube, part.rx_tube, facet.first_piece + k});
      seen.corners_m.insert(seen.corners_m.end(), part.corners_m.begin(), part.corners_m.end());
    }
  }
  return seen;
}

}  // namespace

double VisiblePolygons::area_m2() const {
  double sum = 0;
  PlanarPolygon polygon;
  for (const VisiblePolygon& patch : patches) {
    const FacetPlane plane{patch.normal, patch.distance_m};
    polygon.assign(corners(patch), plane, PlaneFrame(plane));
    sum += area(polygon);
  }
  return sum;
}

VisiblePolygons visible_polygons(const CommonVisibility& visibility, const EchoModel& model) {
  const Path& path = model.path;
  if (!path.tx.facet_map.empty() || !path.facet_factor.empty())
    throw std::invalid_argument(
        "signals need a surface at its true position, but refraction displaces this surface to its apparent "
        "position");
  if (path.over_mirrors() || path.rx || path.tx.to_true != glm::dmat3(1))
    throw std::invalid_argument(
        "patches of straight paths do not apply to mirror paths: see for_coherent_paths()");
  return patches_of(visibility, path.tx.apex_m);
}

VisiblePolygons patches_between(const BistaticHistory& images, glm::dvec3 tx_m) {
  return patches_of(images, tx_m);
}

SplitPolygons split_polygons(const VisiblePolygons& patches, const std::function<bool(FacetId)>& is_smooth) {
  SplitPolygons split;
  split.smooth.origin_m = split.rough.origin_m = patches.origin_m;
  for (const VisiblePolygon& patch : patches.patches) {
    VisiblePolygons& part = is_smooth(patch.facet) ? split.smooth : split.rough;
    const auto corners = patches.corners(patch);
    part.patches.push_back(patch);
    part.patches.back().first_corner = std::uint32_t(part.corners_m.size());
    part.corners_m.insert(part.corners_m.end(), corners.begin(), corners.end());
  }
  return split;
}

VisiblePolygons common_patches(const VisiblePolygons& first, const VisiblePolygons& second) {
  std::vector<std::uint32_t> by_facet(second.patches.size());
  std::iota(by_facet.begin(), by_facet.end(), 0u);
  std::stable_sort(by_facet.begin(), by_facet.end(), [&](std::uint32_t a, std::uint32_t b) {
    return second.patches[a].facet < second.patches[b].facet;
  });
  const glm::dvec3 further = second.origin_m - first.origin_m;
  VisiblePolygons common;
  common.origin_m = first.origin_m;
  PlanarPolygon polygon, other;
  std::vector<glm::dvec3> moved;
  for (const VisiblePolygon& patch : first.patches) {
    stop_if_wanted();
    const FacetPlane plane{patch.normal, patch.distance_m};
    const PlaneFrame frame(plane);
    for (auto k = std::lower_bound(
             by_facet.begin(), by_facet.end(), patch.facet,
             [&](std::uint32_t number, FacetId facet) { return second.patches[number].facet < facet; });
         k != by_facet.end() && second.patches[*k].facet == patch.facet; ++k) {
      const VisiblePolygon& its = second.patches[*k];
      const auto corners = second.corners(its);
      if (!(glm::dot(its.normal, patch.normal) > 0) || apart(first.corners(patch), corners, further))
        continue;
      moved.assign(corners.begin(), corners.end());
      for (glm::dvec3& corner : moved) corner += further;
      polygon.assign(first.corners(patch), plane, frame);
      other.assign(moved, plane, frame);
      if (!clip_convex(polygon, other)) continue;
      VisiblePolygon both = patch;
      both.first_corner = std::uint32_t(common.corners_m.size());
      both.corner_count = std::uint32_t(polygon.offsets.size());
      for (std::size_t i = 0; i < polygon.offsets.size(); ++i) {
        const glm::dvec2 p = polygon.corner(i);
        common.corners_m.push_back(p.x * frame.u + p.y * frame.v - plane.distance_m * plane.normal);
      }
      common.patches.push_back(both);
    }
  }
  return common;
}

}  // namespace tubefoot
