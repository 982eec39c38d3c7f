// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

#include "geometry/mesh/voronoi.hpp"
#include "scene/surfaces/material_map_sources.hpp"

namespace tubefoot {
namespace {

std::uint64_t mixed(std::uint64_t h) {  // SplitMix64 by Steele, Lea and Flood
  h += 0x9e3779b97f4a7c15u;
  h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9u;
  h = (h ^ (h >> 27)) * 0x94d049bb133111ebu;
  return h ^ (h >> 31);
}

/// Returns a number in [0, 1) for a square of the lattice; each square needs three. Integer arithmetic and
/// one exact product give the same result on every machine.
double fraction(std::uint64_t seed, std::int64_t i, std::int64_t j, std::uint64_t which) {
  const std::uint64_t square =
      mixed(mixed(mixed(seed) ^ static_cast<std::uint64_t>(i)) ^ static_cast<std::uint64_t>(j));
  return static_cast<double>(mixed(square + which) >> 11) * 0x1p-53;
}

}  // namespace

MaterialMap patch_material_map(const PatchMaterialMap& map, const MaterialMapSetting& setting) {
  // Every square of the lattice holds one site, so that the nearest site of a position is at most one
  // diagonal of a square away. That site lies at most two squares away, and the sites that bound its cell
  // at most five.
  constexpr std::int64_t covered = 2, margin = 5;
  const double size = map.patch_size_m;
  const glm::dvec2 lo = glm::floor(glm::dvec2(setting.lo_m) / size),
                   hi = glm::floor(glm::dvec2(setting.hi_m) / size);
  const glm::dvec2 squares = hi - lo + static_cast<double>(1 + 2 * margin);
  if (squares.x * squares.y > static_cast<double>(most_material_patches))
    throw InputError(setting.place,
                     fmt::format("patches of {} m on {:.6g} m x {:.6g} m give {:.3g} patches, more than {}: "
                                 "increase 'patch_size_m'",
                                 size, setting.hi_m.x - setting.lo_m.x, setting.hi_m.y - setting.lo_m.y,
                                 squares.x * squares.y, most_material_patches));
  constexpr double far_squares = 0x1p50;  // beyond, rounding loses a site's position within its square
  if (std::max({-lo.x, -lo.y, hi.x, hi.y}) > far_squares)
    throw InputError(setting.place,
                     fmt::format("patches of {} m are too small at this distance from the origin", size));

  std::vector<std::uint16_t> materials;
  double all_shares = 0;
  for (const MaterialShare& share : map.shares) {
    materials.push_back(material_named(share.material, setting.materials, share.place, ""));
    all_shares += share.share;
  }
  std::vector<glm::dvec2> sites;
  std::vector<std::uint32_t> region;  // material by site; none for the default material
  const auto lo_i = static_cast<std::int64_t>(lo.x), lo_j = static_cast<std::int64_t>(lo.y),
             hi_i = static_cast<std::int64_t>(hi.x), hi_j = static_cast<std::int64_t>(hi.y);
  for (std::int64_t j = lo_j - margin; j <= hi_j + margin; ++j)
    for (std::int64_t i = lo_i - margin; i <= hi_i + margin; ++i) {
      sites.emplace_back((static_cast<double>(i) + fraction(map.seed, i, j, 0)) * size,
                         (static_cast<double>(j) + fraction(map.seed, i, j, 1)) * size);
      const bool counts =
          i >= lo_i - covered && i <= hi_i + covered && j >= lo_j - covered && j <= hi_j + covered;
      double left = fraction(map.seed, i, j, 2) * all_shares;
      std::size_t k = 0;
      while (k + 1 < materials.size() && left >= map.shares[k].share) left -= map.shares[k++].share;
      region.push_back(counts && materials[k] != setting.default_material ? materials[k]
                                                                          : MaterialBorder::none);
    }
  std::vector<MaterialBorder> borders;
  for (const VoronoiEdge& edge : voronoi_edges(sites)) {
    const std::uint32_t r = region[edge.site], s = region[edge.other_site];
    if (r != s) borders.push_back({edge.a, edge.b, std::min(r, s), std::max(r, s)});
  }
  check_border_count(borders.size(), setting.place);
  std::vector<std::uint16_t> material_of_region(setting.materials.size());
  for (std::size_t m = 0; m < material_of_region.size(); ++m)
    material_of_region[m] = static_cast<std::uint16_t>(m);
  return {std::move(borders), std::move(material_of_region), setting.default_material};
}

}  // namespace tubefoot
