// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

#include "engine/scattering/beam_pattern.hpp"
#include "geometry/numbers/ball.hpp"
#include "geometry/numbers/complex_ranges.hpp"
#include "geometry/numbers/interval.hpp"

// Beam patterns in balls. Heavy: include only in .cpp files and headers of integrators.
namespace tubefoot {

/// A beam pattern as a function of the cosine w between a direction and its axis.
struct CertifiedGain {
  const Directivity* pattern = nullptr;
  Ball centre_angle;
  std::size_t segment = 0;  ///< of a table, what it is taken for where that is asked for

  CertifiedGain() = default;
  explicit CertifiedGain(const Directivity& directivity);

  bool is_uniform() const { return pattern->kind == Directivity::Kind::uniform; }
  bool is_table() const { return pattern->kind == Directivity::Kind::table; }
  /// Upper bound of the pattern in all directions: 1 but for tables.
  Ball largest() const;

  /// Encloses the pattern over a ball of cosines. `by_segment`: a table is the cubic of its segment.
  /// `otherwise`: where no angle belongs to the cosines.
  Ball at(const Ball& w, bool by_segment, const Ball& otherwise) const;
  /// The same in intervals of doubles; `most`: no pattern is larger.
  Interval at(const Interval& w, bool by_segment, double most) const;

  /// Upper bound of log |pattern| over a rectangle of cosines, of a table that of its segment's cubic;
  /// infinite where it is not analytic.
  double log_bound(const ComplexBall& w) const;
  /// The same in doubles.
  double log_bound(const ComplexRange& w) const;

  /// No zero of it lies within a ball of cosines: its root is as smooth as itself.
  bool has_no_zero(const Ball& w) const;

  /// Takes a table for the cubic of one of its segments over a box of directions, and tells what that may be
  /// wrong by: a bound of |log(gain / that cubic's gain)|.
  double take_segment(const Ball& w);

 private:
  Ball angle_of(const Ball& w) const;
};

}  // namespace tubefoot
