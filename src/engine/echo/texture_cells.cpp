// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/echo/texture_cells.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace tubefoot {
namespace {

/// Splits a convex polygon by the line across . offset = level.
void split(const PlanarPolygon& polygon, glm::dvec2 across, double level, PlanarPolygon& below,
           PlanarPolygon& above) {
  below.offsets.clear();
  above.offsets.clear();
  const std::size_t n = polygon.offsets.size();
  glm::dvec2 from = polygon.offsets[n - 1];
  double height = glm::dot(across, from) - level;
  for (const glm::dvec2 to : polygon.offsets) {
    const double next = glm::dot(across, to) - level;
    if ((height < 0) != (next < 0)) {
      const glm::dvec2 crossing = from + (height / (height - next)) * (to - from);
      below.offsets.push_back(crossing);
      above.offsets.push_back(crossing);
    }
    (next < 0 ? below : above).offsets.push_back(to);
    from = to;
    height = next;
  }
}

}  // namespace

void TextureCells::cut(const PlanarPolygon& polygon, const LyingPlane& plane,
                       const ReflectivityField* texture,
                       const std::function<void(const PlanarPolygon&)>& take) {
  if (texture == nullptr) return take(polygon);
  if (polygon.offsets.size() < 3) return;
  const std::span<const CellPlanes> cells = texture->cells();
  plane_ = plane;
  take_ = &take;
  if (levels_.size() < cells.size()) levels_.resize(cells.size());
  cut(cells, polygon, 0);
}

void TextureCells::cut(std::span<const CellPlanes> cells, const PlanarPolygon& polygon, std::size_t level) {
  if (level == cells.size()) {
    // The first corner of a polygon is the origin of its offsets.
    taken_.distance = polygon.distance;
    taken_.first = polygon.corner(0);
    taken_.offsets.clear();
    for (const glm::dvec2 offset : polygon.offsets) taken_.offsets.push_back(offset - polygon.offsets[0]);
    (*take_)(taken_);
    return;
  }
  // In the polygon's offsets, the family of planes is a set of lines: across . offset = k spacing - foot.
  const CellPlanes& planes = cells[level];
  const glm::dvec2 across{glm::dot(planes.normal, plane_.u), glm::dot(planes.normal, plane_.v)};
  const double foot =
      glm::dot(planes.normal, plane_.foot_m) - planes.offset_m + glm::dot(across, polygon.first);
  double lo = glm::dot(across, polygon.offsets[0]), hi = lo;
  for (const glm::dvec2 offset : polygon.offsets) {
    lo = std::min(lo, glm::dot(across, offset));
    hi = std::max(hi, glm::dot(across, offset));
  }
  // Planes that touch the polygon, within rounding, cut nothing off.
  const double rounding = 1e-12 * (planes.spacing_m + std::abs(foot));
  const double first = std::ceil((foot + lo + rounding) / planes.spacing_m);
  if (!(first * planes.spacing_m < foot + hi - rounding)) return cut(cells, polygon, level + 1);

  Level& own = levels_[level];
  for (PlanarPolygon* made : {&own.rest, &own.part, &own.next}) {
    made->distance = polygon.distance;
    made->first = polygon.first;
  }
  own.rest.offsets = polygon.offsets;
  for (double k = first; k * planes.spacing_m < foot + hi - rounding; ++k) {
    split(own.rest, across, k * planes.spacing_m - foot, own.part, own.next);
    if (own.part.offsets.size() >= 3) cut(cells, own.part, level + 1);
    std::swap(own.rest, own.next);
    if (own.rest.offsets.size() < 3) return;
  }
  cut(cells, own.rest, level + 1);
}

}  // namespace tubefoot
