// SPDX-License-Identifier: GPL-3.0-or-later
// Cuts the tubes of each beam lengthwise into columns of equal angle. The rays that cut a wall are shared
// between the tubes on both sides, so that the parts cover the beam without gaps.
#include "compare/attribution/cut_tubes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <stdexcept>
#include <utility>

namespace tubefoot {
namespace {

/// Two rays in ascending order, so that both adjacent tubes have the same key.
using Wall = std::pair<std::uint32_t, std::uint32_t>;

class Cutter {
 public:
  Cutter(const TubeSet& set, std::size_t columns) : set_(set), columns_(columns) {
    cut_.set.apex = set.apex;
    cut_.set.reach = set.reach;
  }

  /// Cuts the tubes of one beam.
  void cut_beam(const std::vector<std::uint32_t>& tubes) {
    const std::size_t across = short_walls(tubes);
    const std::vector<std::vector<std::uint32_t>> stacks = stacks_of(tubes, across);
    if (columns_ % stacks.size() != 0)
      throw std::invalid_argument(fmt::format(
          "a beam is {} tubes wide, but {} columns are not a multiple of this number: use a multiple of {}",
          stacks.size(), columns_, stacks.size()));
    const std::size_t parts = columns_ / stacks.size();
    for (const auto& stack : stacks) {
      for (const std::uint32_t tube : stack) cut_tube(tube, across, parts);
      next_column_ += static_cast<std::uint32_t>(parts);
    }
  }

  CutTubes done() { return std::move(cut_); }

 private:
  Wall wall(std::uint32_t tube, std::size_t k) const {
    return std::minmax(set_.tubes[tube][k % 4], set_.tubes[tube][(k + 1) % 4]);
  }
  glm::dvec3 unit(std::uint32_t ray) const {
    const GridPoint& r = set_.rays[ray];
    return glm::normalize(glm::dvec3(r.x, r.y, r.z));
  }
  double angle(Wall wall) const {
    return std::acos(std::clamp(glm::dot(unit(wall.first), unit(wall.second)), -1.0, 1.0));
  }

  /// Returns the walls at the ends of the longer side of the beam: 0 for walls 0 and 2, 1 for walls 1 and
  /// 3.
  std::size_t short_walls(const std::vector<std::uint32_t>& tubes) const {
    std::map<Wall, int> uses;
    for (const std::uint32_t t : tubes)
      for (std::size_t k = 0; k < 4; ++k) ++uses[wall(t, k)];
    double length[2] = {0, 0};
    for (const std::uint32_t t : tubes)
      for (std::size_t k = 0; k < 4; ++k)
        if (uses[wall(t, k)] == 1) length[k % 2] += angle(wall(t, k));
    return length[0] <= length[1] ? 0 : 1;
  }

  /// Groups tubes that follow each other lengthwise, by the walls that they share.
  std::vector<std::vector<std::uint32_t>> stacks_of(const std::vector<std::uint32_t>& tubes,
                                                    std::size_t across) const {
    std::map<Wall, std::vector<std::uint32_t>> at;
    for (const std::uint32_t t : tubes)
      for (const std::size_t k : {across, across + 2}) at[wall(t, k)].push_back(t);
    std::vector<std::vector<std::uint32_t>> stacks;
    std::map<std::uint32_t, bool> taken;
    for (const std::uint32_t first : tubes) {
      if (std::exchange(taken[first], true)) continue;
      std::vector<std::uint32_t>& stack = stacks.emplace_back(1, first);
      for (std::size_t n = 0; n < stack.size(); ++n)
        for (const std::size_t k : {across, across + 2})
          for (const std::uint32_t next : at[wall(stack[n], k)])
            if (!std::exchange(taken[next], true)) stack.push_back(next);
    }
    return stacks;
  }

  /// Returns the rays that cut a wall into parts, from its first ray to its second. Adjacent tubes share
  /// them.
  const std::vector<std::uint32_t>& rays_within(Wall wall, std::size_t parts) {
    std::vector<std::uint32_t>& list = within_[wall];
    if (!list.empty()) return list;
    const glm::dvec3 from = unit(wall.first), to = unit(wall.second);
    const double whole = angle(wall);
    for (std::size_t k = 0; k <= parts; ++k) {
      const double part = double(k) / double(parts);
      list.push_back(static_cast<std::uint32_t>(cut_.set.rays.size()));
      cut_.set.rays.push_back(k == 0       ? set_.rays[wall.first]
                              : k == parts ? set_.rays[wall.second]
                                           : integer_ray(glm::normalize(std::sin((1 - part) * whole) * from +
                                                                        std::sin(part * whole) * to)));
    }
    return list;
  }

  void cut_tube(std::uint32_t number, std::size_t across, std::size_t parts) {
    const Tube& tube = set_.tubes[number];
    const std::uint32_t a = tube[across], b = tube[across + 1], c = tube[(across + 2) % 4],
                        d = tube[(across + 3) % 4];
    const auto from = [&](std::uint32_t first, std::uint32_t second) {
      std::vector<std::uint32_t> list = rays_within(std::minmax(first, second), parts);
      if (first > second) std::ranges::reverse(list);
      return list;
    };
    const std::vector<std::uint32_t> low = from(a, b), high = from(d, c);
    for (std::size_t k = 0; k < parts; ++k) {
      cut_.set.tubes.push_back({low[k], low[k + 1], high[k + 1], high[k]});
      cut_.whole.push_back(number);
      // All tubes of a stack count from the same side, because all rows of a grid number their rays in the
      // same order.
      cut_.column.push_back(next_column_ + static_cast<std::uint32_t>(a < b ? k : parts - 1 - k));
    }
  }

  const TubeSet& set_;
  std::size_t columns_;
  std::uint32_t next_column_ = 0;
  std::map<Wall, std::vector<std::uint32_t>> within_;
  CutTubes cut_;
};

}  // namespace

CutTubes cut_into_columns(const TubeSet& set, std::span<const std::uint32_t> beam_of_tube,
                          std::size_t columns) {
  std::map<std::uint32_t, std::vector<std::uint32_t>> beams;
  for (std::uint32_t t = 0; t < set.tubes.size(); ++t) beams[beam_of_tube[t]].push_back(t);
  Cutter cutter(set, columns);
  for (const auto& [beam, tubes] : beams) cutter.cut_beam(tubes);
  return cutter.done();
}

}  // namespace tubefoot
