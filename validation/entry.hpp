// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "validation/kernel_run.hpp"
#include "validation/naive_rays.hpp"

namespace tubefoot::atlas {

/// Result of one arithmetic compared with that of `rational`.
struct Answer {
  CommonVisibility visibility;
  double error = 0;
  bool same_hash = false;
  /// Returns whether areas are equal and every tube closes. (The hash also depends on pieces without area.)
  bool is_right() const { return error == 0 && visibility.unclosed == 0; }
  bool is_exact() const { return is_right() && same_hash; }
};

/// A row of the atlas.
struct Entry {
  Case scene;
  Answer rational, fixed, filtered, plain;
  std::vector<Tolerance> sweep;
  Answer tuned;              ///< double with the best tolerance of the sweep
  double tolerance = 0;      ///< that tolerance
  double as_good_up_to = 0;  ///< largest tolerance of the sweep that is as good; all between are as good, too
  Sampling sampling;
  RayResult usual, robust;

  /// Returns whether the exact arithmetics agree with `rational`, which closes.
  bool exact_ones_agree() const {
    return rational.visibility.unclosed == 0 && fixed.is_exact() && filtered.is_exact();
  }
};

/// Runs all methods on a case; `rays` is n for n x n rays per tube.
Entry evaluate(Case scene, std::uint32_t rays);

/// Number of rays along one side of the grid of a tube.
constexpr std::uint32_t rays_of(Size size, bool one_tube) {
  return (size == Size::page ? 512u : 64u) / (one_tube ? 1u : 2u);
}

}  // namespace tubefoot::atlas
