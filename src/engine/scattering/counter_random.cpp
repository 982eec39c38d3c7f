// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/scattering/counter_random.hpp"

#include <boost/math/special_functions/erf.hpp>
#include <boost/math/special_functions/gamma.hpp>

namespace tubefoot {
namespace {

// All computations are in double, because long double differs between machines. A quantile below the smallest
// double is 0.
using Quietly = boost::math::policies::policy<
    boost::math::policies::promote_double<false>,
    boost::math::policies::underflow_error<boost::math::policies::ignore_error>>;

}  // namespace

std::array<std::uint32_t, 4> philox4x32(std::array<std::uint32_t, 4> counter,
                                        std::array<std::uint32_t, 2> key) {
  constexpr std::uint64_t multiplier_0 = 0xD2511F53, multiplier_2 = 0xCD9E8D57;
  constexpr std::uint32_t weyl_0 = 0x9E3779B9, weyl_1 = 0xBB67AE85;  // golden ratio, sqrt(3) - 1
  constexpr int rounds = 10;
  for (int round = 0; round < rounds; ++round) {
    const std::uint64_t product_0 = multiplier_0 * counter[0], product_2 = multiplier_2 * counter[2];
    counter = {static_cast<std::uint32_t>(product_2 >> 32) ^ counter[1] ^ key[0],
               static_cast<std::uint32_t>(product_2),
               static_cast<std::uint32_t>(product_0 >> 32) ^ counter[3] ^ key[1],
               static_cast<std::uint32_t>(product_0)};
    key[0] += weyl_0;
    key[1] += weyl_1;
  }
  return counter;
}

std::array<double, 2> SampleRandom::uniform_pair(Purpose purpose, std::uint32_t draw) const {
  const auto words =
      philox4x32({sample_, beam_, ping_, static_cast<std::uint32_t>(purpose) << 24 | draw}, key_);
  // 52 bits and a half: exact in a double, and neither 0 nor 1.
  const auto uniform = [](std::uint32_t high, std::uint32_t low) {
    const std::uint64_t bits = (std::uint64_t(high) << 32 | low) >> 12;
    return (static_cast<double>(bits) + 0.5) * 0x1p-52;
  };
  return {uniform(words[1], words[0]), uniform(words[3], words[2])};
}

double gamma_quantile(double probability, double shape) {
  return boost::math::gamma_p_inv(shape, probability, Quietly()) / shape;
}

double normal_quantile(double probability) {
  return -std::numbers::sqrt2 * boost::math::erfc_inv(2 * probability, Quietly());
}

}  // namespace tubefoot
