// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <boost/multiprecision/cpp_int.hpp>
#include <cstdint>

#include "geometry/numbers/int128.hpp"

// Expensive to compile: include it only where products exceed 192 bits, and in .cpp files.
//
// Law W3 (wide integers): sums and products are those of big integers. Conversions to double are within two
// units in the last place.
namespace tubefoot {

/// 512-bit integers, for the rare signs that involve depth planes (at most 474 bits). They allocate no
/// memory.
using WideInt = boost::multiprecision::number<boost::multiprecision::cpp_int_backend<
    512, 512, boost::multiprecision::signed_magnitude, boost::multiprecision::unchecked, void>>;

inline WideInt widen(Int128 x) {
  const bool negative = x < 0;
  const UInt128 magnitude = negative ? -static_cast<UInt128>(x) : static_cast<UInt128>(x);
  WideInt wide = static_cast<std::uint64_t>(magnitude >> 64);
  wide <<= 64;
  wide += static_cast<std::uint64_t>(magnitude);
  if (negative) wide = -wide;
  return wide;
}

}  // namespace tubefoot
