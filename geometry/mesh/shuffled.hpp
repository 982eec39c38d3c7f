// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace tubefoot {

/// Returns the numbers 0 to count - 1 in a fixed pseudorandom order. A constraint that is inserted into a
/// triangulation in this order crosses few edges, even if the constraints form a comb with long teeth.
inline std::vector<std::size_t> shuffled(std::size_t count) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::uint64_t state = 1;
  // Knuth's MMIX generator and a Fisher-Yates shuffle give the same order with every standard library.
  for (std::size_t k = count; k > 1; --k) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    std::swap(order[k - 1], order[(state >> 33) % k]);
  }
  return order;
}

}  // namespace tubefoot
