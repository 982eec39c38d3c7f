// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>

#include "engine/echo/sample_finder.hpp"
#include "engine/visibility/ray_hits.hpp"

// Echoes of rays' hits on a uniform Lambert surface, sixteen hits at a time. hit_lanes.cpp is compiled to
// vector code (vector_clones.hpp). The results have the same digits on every processor.
namespace tubefoot {

/// Echo of the area that each hit of a block represents, in J/m² for 1 J/sr at 1 m. `sample` is the sample
/// that contains the hit's range. It is no_sample outside of all samples, or if range or grazing angle are
/// not positive. The values of lanes beyond the block are arbitrary.
struct LambertEchoes {
  static constexpr std::int32_t no_sample = -1;
  alignas(64) HitBlock::Lanes<double> energy;
  HitBlock::Lanes<std::int32_t> sample;
  bool whole;  ///< sixteen hits of one tube, all in some sample
};

/// Sets Lambert's parameter of each hit of a block. `even_mu`: per material; the last entry is used for
/// materials and facets beyond. Returns the smallest parameter.
double find_mu(const HitBlock& hits, std::span<const std::uint16_t> material, std::span<const double> even_mu,
               HitBlock::Lanes<double>& mu);

/// `mu`: Lambert's parameter of each hit. The relative error of the energies, compared with density() times
/// the area, is at most 1e-15.
LambertEchoes echoes_of(const HitBlock& hits, const HitBlock::Lanes<double>& mu, double beta,
                        const SampleFinder& finder);

/// exp(x) of each lane for x <= 0, with a relative error of at most 4e-16; 0 below -708.
void decay(const HitBlock::Lanes<double>& x, HitBlock::Lanes<double>& out);

}  // namespace tubefoot
