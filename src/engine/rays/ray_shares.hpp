// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/rays/ray_patch.hpp"
#include "engine/rays/ray_sampling.hpp"
#include "geometry/tubes/tube.hpp"

// What samplings share: who gets how many rays.
namespace tubefoot {

/// Twice the mean lengths of a patch's sides.
struct PatchSides {
  double width, height;
  explicit PatchSides(const RayPatch& patch);
};

/// The patches of all tubes. Throws std::invalid_argument as RayPlan.
std::vector<RayPatch> ray_patches(const TubeSet& tubes, const RaySettings& settings,
                                  std::span<const std::uint32_t> beam_of_tube);

/// Tubes by beam, in the order of the beams.
std::vector<std::vector<std::uint32_t>> tubes_of_beams(std::span<const std::uint32_t> beam_of_tube);

/// The tubes that a number of rays is asked for: each beam's, or all of them.
std::vector<std::vector<std::uint32_t>> ray_groups(std::size_t tubes, const RaySettings& settings,
                                                   std::span<const std::uint32_t> beam_of_tube);

/// Deals `rays` in proportion, at least one each.
std::vector<std::int64_t> dealt(const std::vector<double>& parts, std::int64_t rays);

/// Copies directions and weights of some lanes.
void take_lanes(const RayPacket& from, int first, RayPacket& to, int lane, int count);

}  // namespace tubefoot
