// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <cstdint>

// Fixed-width integers of the exact arithmetic. Widths follow from 30-bit coordinates: docs/bit-budget.md.
// Law W3 (wide integers): sums and products are those of big integers, doubles within two units in the last
//   place.
namespace tubefoot {

__extension__ using Int128 = __int128;
__extension__ using UInt128 = unsigned __int128;

/// 512 bits, for the rare signs that involve depth planes (at most 467 bits). No allocation.
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

inline int sign(Int128 x) { return (x > 0) - (x < 0); }

/// A 192-bit two's complement integer: just enough for the dot product of a 123-bit and a 62-bit vector.
struct Int192 {
  std::uint64_t low = 0, mid = 0;
  std::int64_t high = 0;

  Int192& operator+=(const Int192& o) {
    UInt128 sum = UInt128(low) + o.low;
    low = static_cast<std::uint64_t>(sum);
    sum = UInt128(mid) + o.mid + static_cast<std::uint64_t>(sum >> 64);
    mid = static_cast<std::uint64_t>(sum);
    high = static_cast<std::int64_t>(static_cast<std::uint64_t>(high) + static_cast<std::uint64_t>(o.high) +
                                     static_cast<std::uint64_t>(sum >> 64));
    return *this;
  }

  int sign() const { return high < 0 ? -1 : (high | mid | low) != 0; }

  /// Nearest double up to two units in the last place.
  double to_double() const {
    // Negative numbers are negated first: otherwise a small one would be the difference of two huge parts.
    if (high < 0) {
      Int192 positive{~low, ~mid, ~high};
      positive += Int192{1, 0, 0};
      return -positive.to_double();
    }
    return std::ldexp(static_cast<double>(high), 128) + std::ldexp(static_cast<double>(mid), 64) +
           static_cast<double>(low);
  }
};

/// a * b for |a| < 2^126, |b| < 2^63.
inline Int192 multiply(Int128 a, std::int64_t b) {
  const bool negative = (a < 0) != (b < 0);
  const UInt128 ua = a < 0 ? -static_cast<UInt128>(a) : static_cast<UInt128>(a);
  const std::uint64_t ub = b < 0 ? -static_cast<std::uint64_t>(b) : static_cast<std::uint64_t>(b);
  const UInt128 low = UInt128(static_cast<std::uint64_t>(ua)) * ub;
  const UInt128 high =
      UInt128(static_cast<std::uint64_t>(ua >> 64)) * ub + static_cast<std::uint64_t>(low >> 64);
  Int192 product{static_cast<std::uint64_t>(low), static_cast<std::uint64_t>(high),
                 static_cast<std::int64_t>(high >> 64)};
  if (negative) {
    product = {~product.low, ~product.mid, ~product.high};
    product += Int192{1, 0, 0};
  }
  return product;
}

}  // namespace tubefoot
