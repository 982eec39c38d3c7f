// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace tubefoot::prove {

/// SplitMix64 of Steele, Lea and Flood, with integers alone. It gives the same numbers with each compiler,
/// standard library and optimisation. The distributions of <random> do not promise this.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  /// The stream number `index` of a seed: adjacent streams are independent.
  Random(std::uint64_t seed, std::uint64_t index) : state_(mix(mix(seed) + index)) {}

  std::uint64_t next() { return mix(state_ += 0x9e3779b97f4a7c15u); }

  /// Uniform in lo..hi, both included (to within 2^-32 for the ranges used here).
  std::int32_t between(std::int32_t lo, std::int32_t hi) {
    const auto count = static_cast<std::uint64_t>(std::int64_t(hi) - lo + 1);
    return static_cast<std::int32_t>(lo + static_cast<std::int64_t>(next() % count));
  }
  bool one_in(int n) { return between(1, n) == 1; }
  int sign() { return next() & 1 ? 1 : -1; }
  std::size_t index(std::size_t size) { return static_cast<std::size_t>(next() % size); }

  template <class Range>
  void shuffle(Range& range) {
    for (std::size_t k = range.size(); k > 1; --k) std::swap(range[k - 1], range[index(k)]);
  }

 private:
  static std::uint64_t mix(std::uint64_t x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
  }
  std::uint64_t state_;
};

}  // namespace tubefoot::prove
