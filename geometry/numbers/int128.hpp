// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstdint>

// Fixed-width integers of the exact arithmetic: 128-bit integers of the compiler, and a 192-bit integer made
// of them. The widths follow from 30-bit coordinates (docs/notes/bit-budget.md).
namespace tubefoot {

__extension__ using Int128 = __int128;
__extension__ using UInt128 = unsigned __int128;

inline int sign(Int128 x) { return (x > 0) - (x < 0); }

/// A 192-bit two's complement integer. This width suffices for the dot product of a 123-bit and a 62-bit
/// vector.
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

  /// Returns the nearest double up to two units in the last place.
  double to_double() const {
    // A negative number is negated first. Otherwise a small one would be the difference of two huge parts.
    if (high < 0) {
      Int192 positive{~low, ~mid, ~high};
      positive += Int192{1, 0, 0};
      return -positive.to_double();
    }
    return std::ldexp(static_cast<double>(high), 128) + std::ldexp(static_cast<double>(mid), 64) +
           static_cast<double>(low);
  }
};

/// Returns a * b for |a| < 2^126, |b| < 2^63.
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
