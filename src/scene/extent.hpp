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
  /// Returns the horizontal distance between a position and the box; 0 above or below the box.
  double distance_in_plan_m(glm::dvec3 place_m) const;
};

/// Returns "east -20 to 20, north -30 to 30, up -1 to 0 m".
std::string to_text(const Extent& extent);

/// Returns a message with a remedy if a position and the terrain are so far apart that their origins
/// probably differ. Otherwise it returns an empty text.
std::string mixed_frames(glm::dvec3 place_m, const Extent& terrain);

enum class Components { all, terrains };
/// Returns the extent of the components with facets, before the sea surface cuts them.
Extent extent_of(const Scene& scene, Components which);

}  // namespace tubefoot
