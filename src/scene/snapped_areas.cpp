// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/snapped_areas.hpp"

#include <fmt/format.h>

#include <cmath>
#include <glm/geometric.hpp>

namespace tubefoot {
namespace {

constexpr double largest_change = 1e-3;

/// Returns twice the area.
double doubled(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c) { return glm::length(glm::cross(b - a, c - a)); }

double change_of(const SnappedArea& area) { return std::abs(area.snapped_m2 / area.given_m2 - 1); }

}  // namespace

double area_m2(const std::vector<glm::dvec3>& points_m,
               const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  double sum = 0;
  for (const auto& [a, b, c] : triangles) sum += doubled(points_m[a], points_m[b], points_m[c]);
  return sum / 2;
}

double area_m2(const FacetMesh& mesh, const WorldGrid& grid, FacetId first, FacetId last) {
  double sum = 0;
  // Differences are exact, because the coordinates are integers without an origin.
  const auto at = [&](VertexId v) {
    const GridPoint& p = mesh.vertices[v];
    return glm::dvec3(p.x, p.y, p.z);
  };
  for (FacetId f = first; f < last; ++f) {
    const auto& [a, b, c] = mesh.facets[f];
    sum += doubled(at(a), at(b), at(c));
  }
  return sum / 2 * (grid.unit_m() * grid.unit_m());
}

bool SnappedArea::is_changed() const { return given_m2 > 0 && change_of(*this) > largest_change; }

std::string warning_of(const SnappedArea& area, const WorldGrid& grid, int finest_exponent) {
  return fmt::format(
      "'{}': rounding to the grid with its unit of {:.3g} m changes the area from {:.4g} to {:.4g} m2 "
      "({:.2g} %), and the energies accordingly: {}",
      area.name, grid.unit_m(), area.given_m2, area.snapped_m2, 100 * change_of(area),
      finest_exponent > grid.exponent()
          ? fmt::format("set 'grid_exponent' in [run] for a finer grid (at most {} for a scene of this size)",
                        finest_exponent)
          : "no finer grid holds a scene of this size: make the scene smaller or its facets larger");
}

}  // namespace tubefoot
