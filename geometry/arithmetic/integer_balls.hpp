// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <flint/fmpz.h>

#include <boost/multiprecision/cpp_int.hpp>
#include <iterator>
#include <vector>

#include "geometry/arithmetic/wide_vector.hpp"
#include "geometry/numbers/ball_vector.hpp"

// Conversion of long integers to balls. Heavy: include only in .cpp files.
namespace tubefoot {

/// Encloses an integer of any length. The conversion is exact and then rounds outwards once.
template <class Integer>
Ball ball(const Integer& x) {
  std::vector<mp_limb_t> limbs;
  export_bits(x, std::back_inserter(limbs), 64, false);
  fmpz_t integer;
  fmpz_init(integer);
  if (!limbs.empty()) fmpz_set_ui_array(integer, limbs.data(), slong(limbs.size()));
  Ball result;
  arb_set_round_fmpz(result.get(), integer, ball_bits);
  fmpz_clear(integer);
  return x < 0 ? -result : result;
}

inline BallVector balls(const WideVec& v) { return {ball(v[0]), ball(v[1]), ball(v[2])}; }

}  // namespace tubefoot
