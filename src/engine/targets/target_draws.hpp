// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "engine/targets/tube_walls.hpp"
#include "engine/targets/water_target.hpp"
#include "geometry/numbers/world_grid.hpp"

namespace tubefoot {

/// Distances from the apex between which targets are wanted.
struct TargetReach {
  double nearest_m = 0, farthest_m = 0;
};

/// Returns the side of the cubic cells in which a population is drawn. It is the power of two at which a cell
/// has more than one and at most eight targets in the mean.
double draw_cell_m(const TargetPopulation& population);

/// Receives a target of a cell that may meet some tubes, with these tubes in ascending order. The tubes
/// usually are more than those that contain the target.
using TakeDraw = std::function<void(const WaterTarget& target, std::span<const std::uint32_t> tubes)>;

/// Draws a population in all cells that may meet a tube within the reach. Without tubes (null), draws all
/// cells within the reach of the apex. The number of targets of a cell is a Poisson variate, and positions
/// are uniform. The same cell has the same targets in every call (counter_random.hpp). Targets outside of the
/// population's box are omitted. The result contains all targets in the tubes within the reach, and may
/// contain others.
void draw_targets(const TargetPopulation& population, GridPoint apex, const TubeWalls* tubes,
                  const WorldGrid& grid, const TargetReach& reach, const TakeDraw& take);

/// Returns the Poisson variate of a mean of at most 16 at a probability (0 to 1), by inversion.
std::uint32_t poisson_quantile(double probability, double mean);

}  // namespace tubefoot
