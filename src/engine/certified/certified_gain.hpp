// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

#include "engine/scattering/beam_pattern.hpp"
#include "geometry/numbers/ball.hpp"
#include "geometry/numbers/complex_ranges.hpp"
#include "geometry/numbers/interval.hpp"

// Encloses beam patterns in ball arithmetic, in intervals and over complex rectangles. Include this heavy
// header only in .cpp files and in headers of integrators.
namespace tubefoot {

/// Beam pattern as a function of the cosine w between a direction and the pattern's axis.
struct CertifiedGain {
  const Directivity* pattern = nullptr;
  Ball centre_angle;
  std::size_t segment = 0;  ///< segment of a table that represents the table with by_segment

  CertifiedGain() = default;
  explicit CertifiedGain(const Directivity& directivity);

  bool is_uniform() const { return pattern->kind == Directivity::Kind::uniform; }
  bool is_table() const { return pattern->kind == Directivity::Kind::table; }
  /// Upper bound of the pattern in all directions: 1, except for tables.
  Ball largest() const;

  /// Encloses the pattern over a ball of cosines. With `by_segment`, a table is the cubic of its segment.
  /// `otherwise` bounds the pattern where the cosines have no angle.
  Ball at(const Ball& w, bool by_segment, const Ball& otherwise) const;
  /// Does the same in intervals of doubles. `most` is an upper bound of the pattern.
  Interval at(const Interval& w, bool by_segment, double most) const;

  /// Upper bound of log |pattern| over a rectangle of complex cosines. For a table it bounds the cubic of
  /// its segment. Infinite where the pattern is not analytic.
  double log_bound(const ComplexBall& w) const;
  /// Does the same in doubles.
  double log_bound(const ComplexRange& w) const;

  /// Returns whether the pattern has no zero within a ball of cosines. Its square root is then as smooth as
  /// the pattern itself.
  bool has_no_zero(const Ball& w) const;

  /// Replaces a table by the cubic of one of its segments over a box of directions. Returns a bound of the
  /// error |log(gain / gain of this cubic)|.
  double take_segment(const Ball& w);

 private:
  Ball angle_of(const Ball& w) const;
};

}  // namespace tubefoot
