// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/visibility/candidate_facets.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/steps/stop.hpp"

// Collects the candidate facets of a pyramid from the scene tree. Facets that a height field certainly
// hides are separated, because they need no further test.

namespace tubefoot {
namespace {

/// The front is found at `first_front` facets, and again each time their number has grown by a factor. A
/// front that hides nothing has the larger factor. A front of more than a quarter of all facets is not worth
/// its time. The values follow from measurements (validation/performance.md).
constexpr std::size_t first_front = 256, growth_if_idle = 4, growth_if_useful = 2, all_over_front = 4;

float below(std::int32_t x) {
  const auto rounded = static_cast<float>(x);
  return rounded <= static_cast<double>(x)
             ? rounded
             : std::nextafterf(rounded, -std::numeric_limits<float>::infinity());
}

CandidateFacets::ReachBox box_of(const FacetCone& cone) {
  const auto& [a, b, c] = cone.point;
  const auto high = [](std::int32_t x, std::int32_t y, std::int32_t z) {
    return -below(-std::max({x, y, z}));
  };
  const auto low = [](std::int32_t x, std::int32_t y, std::int32_t z) { return below(std::min({x, y, z})); };
  return {low(a.x, b.x, c.x),  low(a.y, b.y, c.y),  low(a.z, b.z, c.z),
          high(a.x, b.x, c.x), high(a.y, b.y, c.y), high(a.z, b.z, c.z)};
}

/// Returns whether the whole facet lies within the reach. A ray that meets such a facet has met nothing
/// beyond the reach before.
bool within_reach(const FacetMesh& mesh, FacetId facet, GridPoint apex, double reach) {
  const double reach2 = reach * reach;
  return std::ranges::all_of(mesh.facets[facet], [&](VertexId v) {
    const GridPoint p = mesh.vertices[v];
    const double x = double(p.x) - apex.x, y = double(p.y) - apex.y, z = double(p.z) - apex.z;
    return x * x + y * y + z * z <= reach2;
  });
}

}  // namespace

CandidateFacets::Wall::Wall(const Vec64& n) {
  const double x = static_cast<double>(n.x), y = static_cast<double>(n.y), z = static_cast<double>(n.z);
  const double length = std::sqrt(x * x + y * y + z * z);
  normal = {x / length, y / length, z / length};
  for (std::size_t k = 0; k < 3; ++k) inner[k] = static_cast<std::uint8_t>(normal[k] > 0 ? k + 3 : k);
}

void CandidateFacets::gather(const FacetMesh& mesh, const SceneTree& tree, GridPoint apex, double reach,
                             const std::array<GridPoint, 4>& rays, bool only_front) {
  std::array<SceneTree::HalfSpace, 4> walls;
  for (std::size_t k = 0; k < 4; ++k) {
    const Vec64 n = cross(rays[k], rays[(k + 1) % 4]);
    walls[k] = {static_cast<double>(n.x), static_cast<double>(n.y), static_cast<double>(n.z)};
  }
  const HeightFields* sheets = tree.height_fields();
  if (sheets) sheets->look(mesh, tree, apex, rays, walls, reach, sheets_);
  candidates_.clear();
  constexpr std::size_t fewest = first_front * all_over_front;
  const bool may_be_many = only_front && mesh.facets.size() >= fewest;
  const std::size_t all = may_be_many ? tree.count(apex, walls, reach) : 0;
  if (all < fewest) {
    tree.query(apex, walls, reach, candidates_);
    return make_facets(mesh, sheets, apex, reach);
  }
  std::size_t next = first_front;
  bool has_front = false, is_useful = false;
  const auto needs = [&](const GridPoint& lowest, const GridPoint& highest, double distance) {
    if (candidates_.size() >= next && all >= candidates_.size() * all_over_front) {
      make_facets(mesh, sheets, apex, reach);
      front_.build(rays, facets_, rings_);
      next = candidates_.size() * (is_useful ? growth_if_useful : growth_if_idle);
      has_front = true;
      is_useful = false;
    }
    const bool is_hidden = has_front && front_.hides(lowest - apex, highest - apex, distance);
    is_useful |= is_hidden;
    return !is_hidden;
  };
  tree.query_by_distance(apex, walls, reach, needs, candidates_);
  make_facets(mesh, sheets, apex, reach);
}

/// Computes the data of the facets candidates_.
void CandidateFacets::make_facets(const FacetMesh& mesh, const HeightFields* sheets, GridPoint apex,
                                  double reach) {
  // The order of the tree depends on the standard library. Sorting removes this dependence.
  stop_if_wanted();
  std::sort(candidates_.begin(), candidates_.end());
  stop_if_wanted();
  facets_.clear();
  boxes_.clear();
  hidden_.clear();
  RangedFacet facet;
  for (const FacetId id : candidates_) {
    const bool subtends = FacetCone::make(mesh, id, apex, facet.cone);
    if (sheets && sheets->surely_hidden(id, subtends ? &facet.cone : nullptr, sheets_) &&
        within_reach(mesh, id, apex, reach)) {
      hidden_.push_back(id);
    } else if (subtends) {
      facet.measure_ranges();
      facets_.push_back(facet);
      boxes_.push_back(box_of(facet.cone));
    }
  }
  rings_.build(facets_);
}

}  // namespace tubefoot
