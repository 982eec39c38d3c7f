// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

#include "engine/echo/sample_finder.hpp"

// Rays' hits on an even Lambert bed, sixteen at once. hit_lanes.cpp becomes vector code (vector_clones.hpp);
// the digits are those of one hit after the other.
namespace tubefoot {

/// Hits side by side, in the order in which their energies are to be added.
struct LambertHits {
  static constexpr std::size_t size = 16;
  using Numbers = std::array<double, size>;
  alignas(64) Numbers range_m, sine, solid_angle_sr, mu;
  std::array<std::size_t, size> row;  ///< of the hit's beam, in the energies
  std::size_t count = 0;
};

/// What each returns from the area that it stands for [J for 1 J/sr at 1 m], and where among the samples it
/// about lies. Lanes from `count` on are anything.
struct LambertEchoes {
  alignas(64) LambertHits::Numbers energy;
  std::array<std::int32_t, LambertHits::size> sample;
};

LambertEchoes echoes_of(const LambertHits& hits, double beta, const SampleFinder& finder);

}  // namespace tubefoot
