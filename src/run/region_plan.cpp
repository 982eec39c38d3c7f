// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/region_plan.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

TileChoice together(const TileChoice& a, const TileChoice& b) {
  TileChoice sum(a.size());
  for (std::size_t i = 0; i < a.size(); ++i)
    std::set_union(a[i].begin(), a[i].end(), b[i].begin(), b[i].end(), std::back_inserter(sum[i]));
  return sum;
}

/// Returns whether two choices of tiles have a tile in common.
bool meet(const TileChoice& a, const TileChoice& b) {
  for (std::size_t i = 0; i < a.size(); ++i)
    for (const std::uint32_t tile : b[i])
      if (std::binary_search(a[i].begin(), a[i].end(), tile)) return true;
  return false;
}

}  // namespace

RegionPlan::RegionPlan(const Transmissions& transmissions, std::uint64_t most_facets) {
  const Survey& survey = transmissions.survey();
  const TilesInView view(*survey.loaded_scene);
  constexpr std::size_t at_once = 256;  // limits the number of choices in memory
  for (std::size_t g = 0; g < survey.transmissions.size(); ++g) {
    const std::size_t pings = survey.sensor_set->pings(survey.transmissions[g]), before = regions_.size();
    for (std::size_t begin = 0; begin < pings; begin += at_once) {
      std::vector<TileChoice> choices(std::min(at_once, pings - begin));
      tbb::parallel_for(std::size_t{0}, choices.size(), [&](std::size_t k) {
        choices[k] = view.of(transmissions, survey.transmissions[g], begin + k);
      });
      for (std::size_t k = 0; k < choices.size(); ++k) {
        stop_if_wanted();
        if (regions_.size() > before) {
          TileChoice& tiles = regions_.back().tiles;
          TileChoice both = together(tiles, choices[k]);
          // Choices without a common tile stay in separate regions. Their tiles would otherwise form two
          // height fields where the whole terrain forms one.
          if (both == tiles || (meet(tiles, choices[k]) && view.facets(both) <= most_facets)) {
            tiles = std::move(both);
            continue;
          }
        }
        regions_.push_back({g, begin + k, std::move(choices[k])});
      }
    }
  }
}

std::size_t RegionPlan::of(std::size_t group, std::size_t ping) const {
  const auto after =
      std::upper_bound(regions_.begin(), regions_.end(), std::pair(group, ping),
                       [](const auto& at, const Region& r) { return at < std::pair(r.group, r.first_ping); });
  return static_cast<std::size_t>(after - regions_.begin()) - 1;
}

}  // namespace tubefoot
