// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/numbers/ball.hpp"
#include "geometry/numbers/interval.hpp"

// Affine functions of position in a plane, in balls and in intervals. This header is expensive to compile, as
// ball.hpp is.
namespace tubefoot {

/// Rounds the enclosure outwards to doubles.
inline Interval interval_of(const Ball& x) { return {x.lo(), x.hi()}; }

/// The function at_foot + along_u x + along_v y of the coordinates of a polygon. A texture coordinate is one,
/// and a cosine times a range.
template <class N>
struct PlaneFunction {
  N at_foot, along_u, along_v;

  /// `M` is N, or a complex type about it.
  template <class M>
  M at(const M& x, const M& y) const {
    return M(at_foot) + M(along_u) * x + M(along_v) * y;
  }
};
inline PlaneFunction<Interval> in_doubles(const PlaneFunction<Ball>& function) {
  return {interval_of(function.at_foot), interval_of(function.along_u), interval_of(function.along_v)};
}

}  // namespace tubefoot
