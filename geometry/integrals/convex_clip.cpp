// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/integrals/convex_clip.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

constexpr double blur = 1e-12;

}  // namespace

bool clip_convex(PlanarPolygon& polygon, const PlanarPolygon& other) {
  const double range = std::hypot(polygon.distance, polygon.first.x, polygon.first.y), width = blur * range;
  const glm::dvec2 shift = other.first - polygon.first;
  std::vector<glm::dvec2> left = polygon.offsets, cut;
  bool moved = false;
  for (std::size_t i = 0; i < other.offsets.size(); ++i) {
    const glm::dvec2 a = shift + other.offsets[i],
                     way = other.offsets[i + 1 == other.offsets.size() ? 0 : i + 1] - other.offsets[i];
    const double length = glm::length(way);
    if (!(length > width)) continue;
    const auto inward = [&](glm::dvec2 p) { return cross(way, p - a) / length; };
    const bool all = std::all_of(left.begin(), left.end(), [&](glm::dvec2 p) { return inward(p) >= -width; });
    if (all) continue;
    moved = true;
    cut.clear();
    glm::dvec2 from = left.back();
    double before = inward(from);
    for (const glm::dvec2 to : left) {
      const double after = inward(to);
      if ((before < 0) != (after < 0)) cut.push_back(from + before / (before - after) * (to - from));
      if (after >= 0) cut.push_back(to);
      from = to;
      before = after;
    }
    // Corners that differ only by rounding would make an edge without a direction.
    left.clear();
    for (const glm::dvec2 p : cut)
      if (left.empty() || glm::distance(left.back(), p) > width) left.push_back(p);
    while (left.size() > 1 && !(glm::distance(left.front(), left.back()) > width)) left.pop_back();
    if (left.size() < 3) return false;
  }
  if (moved) {
    polygon.first += left[0];
    polygon.offsets.clear();
    for (const glm::dvec2 p : left) polygon.offsets.push_back(p - left[0]);
  }
  double around = 0;
  for (std::size_t i = 0; i < left.size(); ++i)
    around += glm::distance(left[i], left[i + 1 == left.size() ? 0 : i + 1]);
  return area(polygon) > width * around;
}

}  // namespace tubefoot
