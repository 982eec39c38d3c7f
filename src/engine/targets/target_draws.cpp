// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/targets/target_draws.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

#include "engine/scattering/counter_random.hpp"
#include "geometry/steps/stop.hpp"

// Draws populations of targets in cubic cells. The walk over the cells halves a box of cells until it is one
// cell, and leaves out boxes that no tube meets.

namespace tubefoot {
namespace {

/// A box of cells: first cell and end along each axis.
struct CellBox {
  std::array<std::int32_t, 3> first{}, end{};
};

class CellWalk {
 public:
  CellWalk(const TargetPopulation& population, GridPoint apex, const TubeWalls* tubes, const WorldGrid& grid,
           const TargetReach& reach, const TakeDraw& take)
      : population_(population),
        grid_(grid),
        reach_(reach),
        take_(take),
        cell_m_(draw_cell_m(population)),
        mean_(population.density_per_m3 * cell_m_ * cell_m_ * cell_m_),
        apex_m_(grid.to_metres(apex)),
        in_tubes_(tubes != nullptr) {
    for (std::uint32_t tube = 0; in_tubes_ && tube < tubes->size(); ++tube) {
      auto& normals = normals_.emplace_back();
      for (std::size_t k = 0; k < 4; ++k) {
        const Vec64& n = tubes->normals(tube)[k];
        const glm::dvec3 normal{double(n.x), double(n.y), double(n.z)};
        const double length = glm::length(normal);
        normals[k] = length > 0 ? normal / length : glm::dvec3(0);
      }
    }
  }

  void walk() {
    CellBox all;
    for (int axis = 0; axis < 3; ++axis) {
      const auto k = static_cast<std::size_t>(axis);
      all.first[k] = static_cast<std::int32_t>(std::floor(population_.lo_m[axis] / cell_m_));
      all.end[k] = static_cast<std::int32_t>(std::ceil(population_.hi_m[axis] / cell_m_));
      if (all.first[k] >= all.end[k]) return;
    }
    lists_.emplace_back();
    for (std::uint32_t tube = 0; tube < normals_.size(); ++tube) lists_[0].push_back(tube);
    visit(all, 0);
  }

 private:
  /// Visits a box of cells, of which the tubes of lists_[depth] may meet a larger box.
  void visit(const CellBox& box, std::size_t depth) {
    if (!select(box, depth)) return;
    std::size_t longest = 0;
    for (std::size_t k = 1; k < 3; ++k)
      if (box.end[k] - box.first[k] > box.end[longest] - box.first[longest]) longest = k;
    if (box.end[longest] - box.first[longest] == 1) return draw(box.first, lists_[depth + 1]);
    CellBox below = box, above = box;
    below.end[longest] = above.first[longest] =
        box.first[longest] + (box.end[longest] - box.first[longest]) / 2;
    visit(below, depth + 1);
    visit(above, depth + 1);
  }

  /// Selects the tubes that may meet a box into lists_[depth + 1]. Returns false without such a tube.
  bool select(const CellBox& box, std::size_t depth) {
    if (lists_.size() < depth + 2) lists_.emplace_back();
    glm::dvec3 lo, hi;
    double near2 = 0, far2 = 0, size = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const auto k = static_cast<std::size_t>(axis);
      lo[axis] = box.first[k] * cell_m_ - apex_m_[axis];
      hi[axis] = box.end[k] * cell_m_ - apex_m_[axis];
      const double nearest = std::max({lo[axis], -hi[axis], 0.0}),
                   farthest = std::max(std::abs(lo[axis]), std::abs(hi[axis]));
      near2 += nearest * nearest;
      far2 += farthest * farthest;
      size = std::max(size, farthest);
    }
    // Targets are rounded to the grid, and the sums below have relative errors of 1e-15.
    const double margin = 2 * grid_.unit_m() + 1e-12 * (size + glm::length(apex_m_));
    if (std::sqrt(near2) > reach_.farthest_m + margin || std::sqrt(far2) < reach_.nearest_m - margin)
      return false;
    std::vector<std::uint32_t>& selected = lists_[depth + 1];
    selected.clear();
    for (const std::uint32_t tube : lists_[depth])
      if (std::ranges::all_of(normals_[tube], [&](const glm::dvec3& n) {
            return std::max(n.x * lo.x, n.x * hi.x) + std::max(n.y * lo.y, n.y * hi.y) +
                       std::max(n.z * lo.z, n.z * hi.z) >=
                   -margin;
          }))
        selected.push_back(tube);
    return !in_tubes_ || !selected.empty();
  }

  void draw(const std::array<std::int32_t, 3>& cell, std::span<const std::uint32_t> tubes) {
    if ((++cells_ & 0xfff) == 0) stop_if_wanted();
    const SampleRandom random(population_.seed, static_cast<std::uint32_t>(cell[0]),
                              static_cast<std::uint32_t>(cell[1]), static_cast<std::uint32_t>(cell[2]));
    const std::uint32_t count = poisson_quantile(random.uniform_pair(Purpose::targets)[0], mean_);
    for (std::uint32_t k = 0; k < count; ++k) {
      const auto [x, y] = random.uniform_pair(Purpose::targets, 1 + 2 * k);
      const auto [z, strength] = random.uniform_pair(Purpose::targets, 2 + 2 * k);
      const glm::dvec3 at_m{(cell[0] + x) * cell_m_, (cell[1] + y) * cell_m_, (cell[2] + z) * cell_m_};
      if (at_m.x < population_.lo_m.x || at_m.y < population_.lo_m.y || at_m.z < population_.lo_m.z ||
          at_m.x >= population_.hi_m.x || at_m.y >= population_.hi_m.y || at_m.z >= population_.hi_m.z)
        continue;
      WaterTarget target;
      target.at = grid_.snap(at_m);
      target.cross_section_m2 = cross_section_m2(
          population_.target_strength_db +
          (population_.spread_db > 0 ? population_.spread_db * normal_quantile(strength) : 0));
      take_(target, tubes);
    }
  }

  const TargetPopulation& population_;
  const WorldGrid& grid_;
  const TargetReach reach_;
  const TakeDraw& take_;
  double cell_m_, mean_;
  glm::dvec3 apex_m_;
  bool in_tubes_;
  std::vector<std::array<glm::dvec3, 4>> normals_;  // per tube, inward unit vectors
  std::vector<std::vector<std::uint32_t>> lists_;   // per depth: tubes that may meet the box
  std::size_t cells_ = 0;
};

}  // namespace

std::uint32_t poisson_quantile(double probability, double mean) {
  double term = std::exp(-mean), sum = term;
  std::uint32_t count = 0;
  // The largest probability is 1 - 2^-53. At a mean of 16 its count is below 70.
  constexpr std::uint32_t most = 200;
  while (probability > sum && count < most) {
    term *= mean / ++count;
    sum += term;
  }
  return count;
}

double draw_cell_m(const TargetPopulation& population) {
  constexpr double most_per_cell = 8;
  return std::exp2(std::floor(std::log2(most_per_cell / population.density_per_m3) / 3));
}

void draw_targets(const TargetPopulation& population, GridPoint apex, const TubeWalls* tubes,
                  const WorldGrid& grid, const TargetReach& reach, const TakeDraw& take) {
  CellWalk(population, apex, tubes, grid, reach, take).walk();
}

}  // namespace tubefoot
