// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

namespace tubefoot {

/// Samples [begin, end).
struct LitSpan {
  std::size_t begin = 0, end = 0;
  bool empty() const { return begin == end; }
};

/// The span from the first to the last sample that is not 0, NaN included. Most samples of a beam are 0;
/// skipping them here costs a fraction of processing them.
inline LitSpan lit_samples(std::span<const double> energies) {
  constexpr std::size_t block = 8;
  const auto silent = [&](std::size_t first) {  // without branches; the sign bit of a zero may be set
    std::uint64_t bits = 0;
    for (std::size_t k = 0; k < block; ++k) bits |= std::bit_cast<std::uint64_t>(energies[first + k]);
    return bits << 1 == 0;
  };
  LitSpan lit{0, energies.size()};
  while (lit.begin + block <= lit.end && silent(lit.begin)) lit.begin += block;
  while (lit.begin < lit.end && energies[lit.begin] == 0) ++lit.begin;
  while (lit.begin + block <= lit.end && silent(lit.end - block)) lit.end -= block;
  while (lit.begin < lit.end && energies[lit.end - 1] == 0) --lit.end;
  return lit;
}

}  // namespace tubefoot
