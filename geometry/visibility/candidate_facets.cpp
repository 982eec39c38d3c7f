// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/visibility/candidate_facets.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/steps/stop.hpp"

// Collects the candidate facets of a run of tubes from the scene tree. Facets that a height field certainly
// hides are separated, because they need no further test.

namespace tubefoot {
namespace {

/// A run with more facets is divided, because the costs in memory would exceed the gain.
constexpr std::size_t most_facets = 1 << 16;

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

std::array<GridPoint, 4> rays_of(const TubeSet& tubes, std::uint32_t tube) {
  const Tube& t = tubes.tubes.at(tube);
  return {tubes.rays[t[0]], tubes.rays[t[1]], tubes.rays[t[2]], tubes.rays[t[3]]};
}

/// Returns whether the whole facet lies within the reach. A ray that meets such a facet has met nothing
/// beyond the reach before.
bool within_reach(const FacetMesh& mesh, FacetId facet, const TubeSet& tubes) {
  const double reach2 = tubes.reach * tubes.reach;
  return std::ranges::all_of(mesh.facets[facet], [&](VertexId v) {
    const GridPoint p = mesh.vertices[v];
    const double x = double(p.x) - tubes.apex.x, y = double(p.y) - tubes.apex.y,
                 z = double(p.z) - tubes.apex.z;
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

bool CandidateFacets::gather(const FacetMesh& mesh, const SceneTree& tree, const TubeSet& tubes,
                             std::uint32_t first, std::uint32_t end) {
  const std::size_t count = end - first;
  for (auto& walls : walls_) walls.clear();
  for (std::uint32_t tube = first; tube < end; ++tube) {
    const std::array<GridPoint, 4> rays = rays_of(tubes, tube);
    for (std::size_t k = 0; k < 4; ++k) {
      const Vec64 n = cross(rays[k], rays[(k + 1) % 4]);
      walls_[k].push_back({static_cast<double>(n.x), static_cast<double>(n.y), static_cast<double>(n.z)});
    }
  }
  candidates_.clear();
  const HeightFields* sheets = tree.height_fields();
  if (count > 1) {
    const std::array<SceneTree::Fan, 4> fans{SceneTree::Fan(walls_[0]), SceneTree::Fan(walls_[1]),
                                             SceneTree::Fan(walls_[2]), SceneTree::Fan(walls_[3])};
    tree.query(tubes.apex, fans, tubes.reach, candidates_);
    if (candidates_.size() > most_facets) return false;
    if (sheets && !sheets->look_over(mesh, tree, tubes.apex, fans, tubes.reach, sheets_)) return false;
  } else {
    const std::array<SceneTree::HalfSpace, 4> walls{walls_[0][0], walls_[1][0], walls_[2][0], walls_[3][0]};
    tree.query(tubes.apex, walls, tubes.reach, candidates_);
    if (sheets) sheets->look(mesh, tree, tubes.apex, rays_of(tubes, first), walls, tubes.reach, sheets_);
  }
  // The order of the tree depends on the standard library. Sorting removes this dependence.
  stop_if_wanted();
  std::sort(candidates_.begin(), candidates_.end());
  stop_if_wanted();
  facets_.clear();
  boxes_.clear();
  hidden_.clear();
  RangedFacet facet;
  for (const FacetId id : candidates_) {
    const bool subtends = FacetCone::make(mesh, id, tubes.apex, facet.cone);
    if (sheets && sheets->surely_hidden(id, subtends ? &facet.cone : nullptr, sheets_) &&
        within_reach(mesh, id, tubes)) {
      hidden_.push_back(id);
    } else if (subtends) {
      facet.measure_ranges();
      facets_.push_back(facet);
      boxes_.push_back(box_of(facet.cone));
    }
  }
  rings_.build(facets_);
  return true;
}

}  // namespace tubefoot
