// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/echo/hit_lanes.hpp"

#include <cmath>

#include "geometry/numbers/vector_clones.hpp"

namespace tubefoot {
namespace {

constexpr std::size_t lanes = LambertHits::size;
using Numbers = LambertHits::Numbers;

TUBEFOOT_VECTOR_CLONES
void energies(const LambertHits& hits, const Numbers& absorbed, Numbers& energy) {
  double* __restrict out = energy.data();
  for (std::size_t k = 0; k < lanes; ++k) {
    // In the order of density() and of what a hit stands for, so that the digits are those.
    const double r = hits.range_m[k], sine = hits.sine[k], product = r * r;
    const double sigma = hits.mu[k] * sine * sine;
    out[k] = sigma * absorbed[k] / (product * product) * (hits.solid_angle_sr[k] * (r * r) / sine);
  }
}

TUBEFOOT_VECTOR_CLONES
void samples(const LambertHits& hits, double first_m, double per_m, double last,
             std::array<std::int32_t, lanes>& sample) {
  std::int32_t* __restrict out = sample.data();
  for (std::size_t k = 0; k < lanes; ++k) {
    const double at = (hits.range_m[k] - first_m) * per_m;
    out[k] = std::int32_t(at < last ? at : last);
  }
}

}  // namespace

LambertEchoes echoes_of(const LambertHits& hits, double beta, const SampleFinder& finder) {
  LambertEchoes echoes;
  alignas(64) Numbers absorbed;
  absorbed.fill(1);
  if (beta != 0)
    for (std::size_t k = 0; k < hits.count; ++k)
      absorbed[k] = std::exp(-(beta * (hits.range_m[k] + hits.range_m[k])));
  energies(hits, absorbed, echoes.energy);
  samples(hits, finder.borders().front(), finder.samples_per_m(), double(finder.borders().size() - 2),
          echoes.sample);
  return echoes;
}

}  // namespace tubefoot
