// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>

#include "engine/echo/sample_finder.hpp"
#include "engine/visibility/ray_hits.hpp"

// Rays' hits on an even Lambert seabed, sixteen at once. hit_lanes.cpp becomes vector code
// (vector_clones.hpp); the digits are the same on every processor.
namespace tubefoot {

/// What each hit of a block returns from the area that it stands for [J for 1 J/sr at 1 m], and the sample
/// that holds its range; no_sample where none does, or where range or grazing angle are not above 0. Lanes
/// beyond the block's are anything.
struct LambertEchoes {
  static constexpr std::int32_t no_sample = -1;
  alignas(64) HitBlock::Lanes<double> energy;
  HitBlock::Lanes<std::int32_t> sample;
  bool whole;  ///< sixteen hits of one tube, all in some sample
};

/// Lambert's parameter under each hit of a block: `even_mu` by material, its last entry that of materials
/// and facets beyond. Returns the least of them.
double find_mu(const HitBlock& hits, std::span<const std::uint16_t> material, std::span<const double> even_mu,
               HitBlock::Lanes<double>& mu);

/// `mu`: Lambert's parameter under each hit. Energies are within 1e-15, relative, of what density() returns
/// times the area.
LambertEchoes echoes_of(const HitBlock& hits, const HitBlock::Lanes<double>& mu, double beta,
                        const SampleFinder& finder);

/// exp(x) of each, x at most 0, within 4e-16, relative; 0 below -708.
void decay(const HitBlock::Lanes<double>& x, HitBlock::Lanes<double>& out);

}  // namespace tubefoot
