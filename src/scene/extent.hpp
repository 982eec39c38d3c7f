// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec3.hpp>
#include <limits>
#include <string>

namespace tubefoot {

struct Scene;

/// A box in the local frame.
struct Extent {
  glm::dvec3 lo_m{std::numeric_limits<double>::infinity()}, hi_m{-std::numeric_limits<double>::infinity()};

  bool empty() const { return lo_m.x > hi_m.x; }
  void add(glm::dvec3 point_m);
  /// Between a place and the box as seen from above; 0 over or under it.
  double distance_in_plan_m(glm::dvec3 place_m) const;
};

/// "east -20 to 20, north -30 to 30, up -1 to 0 m".
std::string to_text(const Extent& extent);

/// What is amiss where a place and the terrain are so far from each other that they count from two origins,
/// and what to do; else empty.
std::string mixed_frames(glm::dvec3 place_m, const Extent& terrain);

enum class Components { all, terrains };
/// Of the components with facets, before the sea surface cuts them.
Extent extent_of(const Scene& scene, Components which);

}  // namespace tubefoot
