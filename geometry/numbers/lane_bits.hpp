// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

// Comparisons of several numbers at once, with bits as result. The vectors have 16 bytes because every
// processor compares these at once. Longer vectors would be compared number by number on some processors.
namespace tubefoot {

using TwoDoubles = double __attribute__((vector_size(16)));
using TwoLanes = std::int64_t __attribute__((vector_size(16)));
using FourFloats = float __attribute__((vector_size(16)));
using FourLanes = std::int32_t __attribute__((vector_size(16)));

/// Returns bit k set if lane k is all ones; each lane is all ones or all zeros. The caller casts the result
/// of a comparison to one of these types, because the type of the result differs between compilers.
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
