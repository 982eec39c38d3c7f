// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

// Comparisons of a few numbers at once, as bits. Vectors of 16 bytes: every processor compares those at once,
// where longer ones are taken apart, a number at a time.
namespace tubefoot {

using TwoDoubles = double __attribute__((vector_size(16)));
using TwoLanes = std::int64_t __attribute__((vector_size(16)));
using FourFloats = float __attribute__((vector_size(16)));
using FourLanes = std::int32_t __attribute__((vector_size(16)));

/// Bit k: whether lane k, all ones or all zeros, is all ones. (What a comparison gives is cast to one of
/// these: which type it has by itself differs from compiler to compiler.)
inline unsigned bits_of(TwoLanes lanes) {
#if defined(__SSE2__)
  return static_cast<unsigned>(__builtin_ia32_movmskpd(TwoDoubles(lanes)));
#else
  return static_cast<unsigned>((lanes[0] & 1) | (lanes[1] & 2));
#endif
}
inline unsigned bits_of(FourLanes lanes) {
#if defined(__SSE2__)
  return static_cast<unsigned>(__builtin_ia32_movmskps(FourFloats(lanes)));
#else
  return static_cast<unsigned>((lanes[0] & 1) | (lanes[1] & 2) | (lanes[2] & 4) | (lanes[3] & 8));
#endif
}

}  // namespace tubefoot
