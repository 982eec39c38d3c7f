// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/visibility/far_view.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <stdexcept>

#include "engine/visibility/tube_engine.hpp"
#include "geometry/numbers/scalars.hpp"
#include "geometry/search/scene_tree.hpp"

// Computes the visible parts of a mesh along parallel lines. A projective map replaces the parallel lines by
// rays from an apex. The tube engine computes the exact visible polygons, whose corners are mapped back.

namespace tubefoot {
namespace {

// In radii of the bounding sphere. Mapped points lie within 4/3 of the middle and 16/3 of the apex, which
// fits 30 bits with a unit of 2^-27.
constexpr double apex_height = FarViewGrid::apex_height;

/// Directions right, up and towards the viewer.
struct ViewFrame {
  glm::dvec3 upwards, u, v, w;
  explicit ViewFrame(glm::dvec3 towards) : w(towards) {
    const glm::dvec3 size = glm::abs(w);
    upwards = size.z <= size.x || size.z <= size.y ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0);
    u = glm::normalize(glm::cross(upwards, w));
    v = glm::cross(w, u);
  }
};

/// Returns a sector that contains [lo, hi] of the plane through the middle, divided into tubes with about
/// equal numbers of facets.
TubeSet window(const WorldGrid& grid, glm::dvec2 lo, glm::dvec2 hi, std::size_t facets) {
  constexpr double facets_a_tube = 128;
  const auto across = static_cast<std::uint32_t>(
      std::clamp(std::ceil(std::sqrt(static_cast<double>(facets) / facets_a_tube)), 1.0, 256.0));
  TubeSet set{grid.snap({0, 0, apex_height}), {}, {}, 8 / grid.unit_m()};
  const double scale = 1 / grid.unit_m();
  for (std::uint32_t i = 0; i <= across; ++i)
    for (std::uint32_t j = 0; j <= across; ++j) {
      const glm::dvec2 at = lo + (hi - lo) * glm::dvec2(i, j) / static_cast<double>(across);
      set.rays.push_back({static_cast<std::int32_t>(std::lround(at.x * scale)),
                          static_cast<std::int32_t>(std::lround(at.y * scale)),
                          static_cast<std::int32_t>(std::lround(-apex_height * scale))});
    }
  for (std::uint32_t i = 0; i < across; ++i)
    for (std::uint32_t j = 0; j < across; ++j) {
      const std::uint32_t corner = i * (across + 1) + j;
      set.tubes.push_back({corner, corner + 1, corner + across + 2, corner + across + 1});
    }
  return set;
}

}  // namespace

double FarView::area_m2() const {
  double twice = 0;
  for (const Part& part : parts)
    for (std::uint32_t k = 2; k < part.count; ++k) {
      const glm::dvec2 first = across_m[part.first];
      twice += cross(across_m[part.first + k - 1] - first, across_m[part.first + k] - first);
    }
  return twice / 2;
}

FarView far_view(std::span<const glm::dvec3> points_m,
                 std::span<const std::array<std::uint32_t, 3>> triangles, glm::dvec3 towards,
                 FarViewGrid* exact) {
  if (points_m.empty() || triangles.empty()) return {};
  glm::dvec3 lo = points_m[0], hi = lo;
  for (const glm::dvec3& p : points_m) {
    lo = glm::min(lo, p);
    hi = glm::max(hi, p);
  }
  const glm::dvec3 middle = (lo + hi) / 2.0;
  double radius = 0;
  for (const glm::dvec3& p : points_m) radius = std::max(radius, glm::length(p - middle));
  if (!(radius > 0) || !std::isfinite(radius))
    throw std::invalid_argument("a mesh must have finite points that are not all identical");
  const ViewFrame frame(towards);
  std::vector<glm::dvec3> mapped;
  mapped.reserve(points_m.size());
  glm::dvec2 least(1), most(-1);
  for (const glm::dvec3& p : points_m) {
    const glm::dvec3 from = (p - middle) / radius;
    const glm::dvec3 seen{glm::dot(from, frame.u), glm::dot(from, frame.v), glm::dot(from, frame.w)};
    least = glm::min(least, glm::dvec2(seen));
    most = glm::max(most, glm::dvec2(seen));
    mapped.push_back(seen / (1 + seen.z / apex_height));
  }
  const WorldGrid grid(FarViewGrid::exponent, glm::dvec3(0));
  MeshBuilder builder(grid);
  builder.add(mapped, {triangles.begin(), triangles.end()}, 0, 0);
  MeshReport report;
  const FacetMesh mesh = builder.finish(report);
  const SceneTree tree(mesh, SceneTree::HeightFieldSearch::ignored);
  constexpr double margin = 1e-6;  // much larger than the grid's unit
  const History history =
      TubeEngine(mesh, tree, grid.unit_m(), {})
          .trace(window(grid, least - margin, most + margin, triangles.size()), nullptr, false);

  if (exact != nullptr) {
    *exact = {middle, radius, frame.upwards, {}, {}};
    for (const glm::dvec3& m : mapped) exact->vertices.push_back(grid.snap(m));
  }
  FarView view;
  const FootprintSet& set = history.footprints;
  const glm::dvec3 origin{glm::dot(middle, frame.u), glm::dot(middle, frame.v), glm::dot(middle, frame.w)};
  for (const Footprint& footprint : set.footprints)
    for (std::uint32_t k = 0; k < footprint.piece_count; ++k) {
      const Piece& piece = set.pieces[footprint.first_piece + k];
      view.parts.push_back({footprint.facet, static_cast<std::uint32_t>(view.across_m.size()), piece.count});
      // Pieces turn as the rays of tubes do, which is the opposite sense here.
      for (std::uint32_t corner = piece.count; corner-- > 0;) {
        const glm::dvec3 c = set.corners_m[piece.first + corner];  // relative to the apex
        const double scale = -apex_height / c.z;
        view.across_m.push_back(glm::dvec2(origin) + radius * scale * glm::dvec2(c));
        view.towards_m.push_back(origin.z + radius * scale * (apex_height + c.z));
        if (exact != nullptr) exact->corners.push_back(c);
      }
    }
  return view;
}

}  // namespace tubefoot
