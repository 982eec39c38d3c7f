// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/rays/ray_shares.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <numeric>
#include <stdexcept>

namespace tubefoot {

PatchSides::PatchSides(const RayPatch& patch) {
  const auto& c = patch.corners();
  width = glm::length(c[1] - c[0]) + glm::length(c[2] - c[3]);
  height = glm::length(c[3] - c[0]) + glm::length(c[2] - c[1]);
}

std::vector<RayPatch> ray_patches(const TubeSet& tubes, const RaySettings& settings,
                                  std::span<const std::uint32_t> beam_of_tube) {
  const std::size_t count = tubes.tubes.size();
  if (settings.rays < 0)
    throw std::invalid_argument(fmt::format("the number of rays must be 0 or more, not {}", settings.rays));
  if ((settings.sampling == RaySampling::column || settings.per == RaySettings::Per::beam) &&
      beam_of_tube.size() != count)
    throw std::invalid_argument(
        fmt::format("rays per beam need a beam for each of the {} tubes, but {} tubes have a beam", count,
                    beam_of_tube.size()));
  std::vector<RayPatch> patches;
  for (std::size_t t = 0; t < count; ++t) {
    patches.emplace_back(tubes, tubes.tubes[t]);
    if (!patches[t].is_convex())
      throw std::invalid_argument(fmt::format(
          "tube {} is not a convex pyramid with a solid angle, so no rays are possible in it", t));
  }
  return patches;
}

std::vector<std::vector<std::uint32_t>> tubes_of_beams(std::span<const std::uint32_t> beam_of_tube) {
  std::map<std::uint32_t, std::vector<std::uint32_t>> beams;
  for (std::uint32_t t = 0; t < beam_of_tube.size(); ++t) beams[beam_of_tube[t]].push_back(t);
  std::vector<std::vector<std::uint32_t>> lists;
  for (auto& [beam, list] : beams) lists.push_back(std::move(list));
  return lists;
}

std::vector<std::vector<std::uint32_t>> ray_groups(std::size_t tubes, const RaySettings& settings,
                                                   std::span<const std::uint32_t> beam_of_tube) {
  if (settings.per == RaySettings::Per::beam) return tubes_of_beams(beam_of_tube);
  std::vector<std::uint32_t> all(tubes);
  std::iota(all.begin(), all.end(), 0u);
  return {all};
}

std::vector<std::int64_t> dealt(const std::vector<double>& parts, std::int64_t rays) {
  double total = 0, before = 0;
  for (const double part : parts) total += part;
  // The code rounds the running total and not each share, so that the sum remains `rays`.
  const auto share = [&](double sum) { return std::int64_t(std::llround(double(rays) * (sum / total))); };
  std::vector<std::int64_t> counts;
  for (const double part : parts) {
    counts.push_back(rays == 0 ? 0 : std::max<std::int64_t>(share(before + part) - share(before), 1));
    before += part;
  }
  return counts;
}

void take_lanes(const RayPacket& from, int first, RayPacket& to, int lane, int count) {
  for (const auto numbers : {&RayPacket::x, &RayPacket::y, &RayPacket::z, &RayPacket::weight})
    std::copy_n((from.*numbers).begin() + first, count, (to.*numbers).begin() + lane);
}

}  // namespace tubefoot
