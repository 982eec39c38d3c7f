// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>

#include "engine/scattering/scattering_model.hpp"
#include "geometry/numbers/ball.hpp"
#include "geometry/numbers/interval.hpp"

// Encloses cross-sections of scattering models in ball arithmetic and in intervals. Include this heavy
// header only in .cpp files.
namespace tubefoot {

inline Ball power_of(const Ball& x, double exponent) {
  if (exponent == 0) return Ball(1);
  if (exponent == 2) return squared(x);
  Ball result;
  const Ball e(exponent);
  arb_pow(result.get(), x.get(), e.get(), ball_bits);
  return result;
}
/// Not finite where x touches the negative axis.
inline ComplexBall power_of(const ComplexBall& x, double exponent) {
  if (exponent == 0) return ComplexBall(1.0);
  if (exponent == 2) return squared(x);
  ComplexBall result;
  const ComplexBall e(exponent);
  acb_pow_analytic(result.get(), x.get(), e.get(), 1, ball_bits);
  return result;
}

/// Cross-section of a piece's terms at any angle, even outside of the piece. `sine` is that of the grazing
/// angle.
template <class N>
N cross_section_in(const ScatteringModel::Piece& piece, const N& incidence, const N& sine) {
  N sum;
  for (const ScatteringModel::Term& t : piece.terms) {
    N value = N(Ball(t.level)) * power_of(sine, t.power);
    if (t.slope != 0 || t.curvature != 0)
      value = value * exp(N(Ball(t.slope)) * (incidence - N(Ball(piece.from))) -
                          N(Ball(t.curvature)) * squared(incidence));
    sum += value;
  }
  return sum;
}

/// The following functions use intervals of doubles.
inline Interval power_of(const Interval& x, double exponent) {
  if (exponent == 0) return 1;
  if (exponent == 2) return squared(x);
  const double a = std::pow(std::max(x.lo, 0.0), exponent), b = std::pow(std::max(x.hi, 0.0), exponent);
  return outwards(std::min(a, b), std::max(a, b), library_units);
}
inline Interval cross_section_in(const ScatteringModel::Piece& piece, const Interval& incidence,
                                 const Interval& sine) {
  Interval sum;
  for (const ScatteringModel::Term& t : piece.terms) {
    Interval value = t.level * power_of(sine, t.power);
    if (t.slope != 0 || t.curvature != 0)
      value = value * exp(t.slope * (incidence - piece.from) - t.curvature * squared(incidence));
    sum += value;
  }
  return sum;
}
inline Interval cross_section_over(const ScatteringModel& model, const Interval& incidence,
                                   const Interval& sine) {
  const auto& pieces = model.pieces();
  Interval all;
  bool any = false;
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    if (incidence.hi < pieces[k].from && k > 0) continue;
    if (incidence.lo > pieces[k].to && k + 1 < pieces.size()) continue;
    const Interval own = cross_section_in(pieces[k], incidence, sine);
    all = any ? hull(all, own) : own;
    any = true;
  }
  return all;
}

/// Cross-section of the whole model over a ball of angles.
inline Ball cross_section_over(const ScatteringModel& model, const Ball& incidence, const Ball& sine) {
  Ball all;
  bool any = false;
  const auto& pieces = model.pieces();
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    const bool last = k + 1 == pieces.size();
    if (incidence.hi() < pieces[k].from && k > 0) continue;
    if (incidence.lo() > pieces[k].to && !last) continue;
    const Ball own = cross_section_in(pieces[k], incidence, sine);
    if (any)
      arb_union(all.get(), all.get(), own.get(), ball_bits);
    else
      all = own;
    any = true;
  }
  return all;
}

}  // namespace tubefoot
