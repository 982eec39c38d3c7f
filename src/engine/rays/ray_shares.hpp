// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/rays/ray_patch.hpp"
#include "engine/rays/ray_sampling.hpp"
#include "geometry/tubes/tube.hpp"

// Common functions of the samplings: the distribution of rays among tubes and beams.
namespace tubefoot {

/// Twice the mean lengths of a patch's sides.
struct PatchSides {
  double width, height;
  explicit PatchSides(const RayPatch& patch);
};

/// Returns the patches of all tubes. Throws std::invalid_argument as RayPlan does.
std::vector<RayPatch> ray_patches(const TubeSet& tubes, const RaySettings& settings,
                                  std::span<const std::uint32_t> beam_of_tube);

/// Returns the tubes of each beam, in the order of the beams.
std::vector<std::vector<std::uint32_t>> tubes_of_beams(std::span<const std::uint32_t> beam_of_tube);

/// Returns the groups of tubes among which a number of rays is distributed: those of each beam, or all tubes.
std::vector<std::vector<std::uint32_t>> ray_groups(std::size_t tubes, const RaySettings& settings,
                                                   std::span<const std::uint32_t> beam_of_tube);

/// Distributes `rays` in proportion to `parts`, at least one ray per part.
std::vector<std::int64_t> dealt(const std::vector<double>& parts, std::int64_t rays);

/// Copies directions and weights of some lanes.
void take_lanes(const RayPacket& from, int first, RayPacket& to, int lane, int count);

}  // namespace tubefoot
