// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/visibility/front.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

// Projects the facets found so far to the gnomonic plane of a pyramid and finds the cells that they close.

namespace tubefoot {
namespace {

/// Enlargement of distances and bounds of boxes, relative: far more than the rounding errors of either.
constexpr double margin = 1e-9;

}  // namespace

void Front::build(const std::array<GridPoint, 4>& rays, const std::vector<RangedFacet>& facets,
                  EdgeRings& rings) {
  frame_ = GnomonicFrame(rays);
  facets_.clear();
  for (const RangedFacet& facet : facets) facets_.emplace_back(facet).place(frame_);
  all_.resize(facets.size());
  std::iota(all_.begin(), all_.end(), 0u);
  rings.find_neighbours(facets, all_, 2, neighbours_, crowded_);
  grid_.build(frame_, facets_, neighbours_);
}

bool Front::hides(GridPoint lowest, GridPoint highest, double distance) const {
  Bounds bounds = Bounds::nothing();
  for (unsigned corner = 0; corner < 8; ++corner) {
    const glm::dvec3 d(corner & 1u ? highest.x : lowest.x, corner & 2u ? highest.y : lowest.y,
                       corner & 4u ? highest.z : lowest.z);
    glm::dvec2 p;
    if (!frame_.project(d, glm::length(d), p)) return false;
    bounds.add(p);
  }
  bounds.widen(margin * (1 + std::max({std::abs(bounds.x0), std::abs(bounds.x1), std::abs(bounds.y0),
                                       std::abs(bounds.y1)})));
  return grid_.hides(bounds, distance * (1 - margin));
}

}  // namespace tubefoot
