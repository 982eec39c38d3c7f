// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/echo/hit_lanes.hpp"

#include <algorithm>
#include <bit>

#include "geometry/numbers/vector_clones.hpp"

// Computes the echoes of hits on uniform Lambert surfaces in vector code, with its own exponential. The
// energy of a hit is mu sin(grazing) * absorption * solid angle / r^2.

namespace tubefoot {
namespace {

constexpr std::size_t lanes = HitBlock::size;
using Numbers = HitBlock::Lanes<double>;

/// exp(x) for -708 <= x <= 0, as 2^n exp(f) with |f| at most half of log 2. The largest relative error of
/// the polynomial is 1.7e-17 (Chebyshev fit of degree 11, coefficients rounded to double). The other errors
/// are roundings. The library's exp, which density() uses, computes one number at a time.
__attribute__((always_inline)) inline double exp_of(double x) {
  constexpr double log2_e = 0x1.71547652b82fep0;
  // n ln2_high is exact
  constexpr double ln2_high = 0x1.62e42feep-1, ln2_low = 0x1.a39ef35793c76p-33;
  constexpr double to_integer = 0x1.8p52;  // adding it rounds to an integer in the lowest bits
  const double shifted = x * log2_e + to_integer, n = shifted - to_integer;
  const double f = (x - n * ln2_high) - n * ln2_low, f2 = f * f, f4 = f2 * f2;
  const double low = (1 + f) + f2 * (0x1.0000000000011p-1 + f * 0x1.555555555555ap-3);
  const double middle = (0x1.555555554f0cep-5 + f * 0x1.111111110f225p-7) +
                        f2 * (0x1.6c16c187fbe13p-10 + f * 0x1.a01a01b14379ap-13);
  const double high = (0x1.a01991ac8440bp-16 + f * 0x1.71ddf5749b43dp-19) +
                      f2 * (0x1.28b40581fba5cp-22 + f * 0x1.af631d03b18bfp-26);
  constexpr std::uint64_t bias = 1023;
  const auto power = std::bit_cast<double>((std::bit_cast<std::uint64_t>(shifted) + bias) << 52);
  return (low + f4 * (middle + f4 * high)) * power;
}

}  // namespace

TUBEFOOT_VECTOR_CLONES
void decay(const Numbers& x, Numbers& out) {
  constexpr double least = -708;
  double* __restrict to = out.data();
  for (std::size_t k = 0; k < lanes; ++k) {
    const double kept = x[k] > least ? x[k] : least;
    const double value = exp_of(kept);
    to[k] = x[k] >= least ? value : 0;
  }
}

namespace {

TUBEFOOT_VECTOR_CLONES
void energies(const HitBlock& hits, const Numbers& mu, const Numbers& absorbed, Numbers& energy) {
  double* __restrict out = energy.data();
  for (std::size_t k = 0; k < lanes; ++k) {
    // mu sine^2 / r^4 times the area solid_angle r^2 / sine.
    const double r = hits.slant_range_m[k];
    out[k] = mu[k] * hits.sine_grazing[k] * absorbed[k] * hits.solid_angle_sr[k] / (r * r);
  }
}

/// Returns whether the block has sixteen hits of one tube, all in some sample.
TUBEFOOT_VECTOR_CLONES
bool samples(const HitBlock& hits, const RangeSamples& own, double per_m, double end_m,
             HitBlock::Lanes<std::int32_t>& sample) {
  const RangeSamples all = own;
  const double first = all.border_m(0), last = double(all.count - 1);
  std::int32_t* __restrict out = sample.data();
  for (std::size_t k = 0; k < lanes; ++k) {
    const double r = hits.slant_range_m[k], at = (r - first) * per_m;
    const bool is_in = (r >= first) & (r < end_m) & (r > 0) & (hits.sine_grazing[k] > 0);
    const double inside = at < last ? at : last;
    const auto near = std::int32_t(inside > 0 ? inside : 0);
    // The comparison with the borders decides, not the product.
    const std::int32_t exact = near + std::int32_t(r >= all.border_m(double(near + 1))) -
                               std::int32_t(r < all.border_m(double(near)));
    out[k] = is_in ? exact : LambertEchoes::no_sample;
  }
  std::uint32_t other = 0;
  std::int32_t none = 0;
  for (std::size_t k = 0; k < lanes; ++k) {
    other |= hits.tube[k] ^ hits.tube[0];
    none |= out[k];
  }
  return hits.count == lanes && other == 0 && none >= 0;
}

TUBEFOOT_VECTOR_CLONES
void exponents(const HitBlock& hits, double beta, Numbers& out) {
  double* __restrict to = out.data();
  for (std::size_t k = 0; k < lanes; ++k) to[k] = -(beta * (hits.slant_range_m[k] + hits.slant_range_m[k]));
}

}  // namespace

double find_mu(const HitBlock& hits, std::span<const std::uint16_t> material, std::span<const double> even_mu,
               Numbers& mu) {
  const std::size_t other = even_mu.size() - 1;
  std::size_t farthest = 0;
  for (std::size_t k = 0; k < hits.count; ++k) farthest = std::max<std::size_t>(farthest, hits.facet[k]);
  if (farthest < material.size())
    for (std::size_t k = 0; k < hits.count; ++k)
      mu[k] = even_mu[std::min<std::size_t>(material[hits.facet[k]], other)];
  else
    for (std::size_t k = 0; k < hits.count; ++k)
      mu[k] = even_mu[hits.facet[k] < material.size() ? std::min<std::size_t>(material[hits.facet[k]], other)
                                                      : other];
  double least = mu[0];
  for (std::size_t k = 1; k < hits.count; ++k) least = std::min(least, mu[k]);
  return least;
}

LambertEchoes echoes_of(const HitBlock& hits, const Numbers& mu, double beta, const SampleFinder& finder) {
  LambertEchoes echoes;
  alignas(64) Numbers absorbed, exponent;
  absorbed.fill(1);
  if (beta != 0) {
    exponents(hits, beta, exponent);
    decay(exponent, absorbed);
  }
  energies(hits, mu, absorbed, echoes.energy);
  echoes.whole =
      samples(hits, finder.samples(), finder.samples_per_m(), finder.borders().back(), echoes.sample);
  return echoes;
}

}  // namespace tubefoot
