// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "engine/scattering/scattering_model.hpp"
#include "geometry/numbers/ball.hpp"
#include "geometry/numbers/interval.hpp"

// Computes cross-sections of scattering models in ball arithmetic, in intervals and in dual numbers. Include
// this heavy header only in .cpp files and in headers of integrators.
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

inline Interval power_of(const Interval& x, double exponent) {
  if (exponent == 0) return 1;
  if (exponent == 2) return squared(x);
  const double a = std::pow(std::max(x.lo, 0.0), exponent), b = std::pow(std::max(x.hi, 0.0), exponent);
  return outwards(std::min(a, b), std::max(a, b), library_units);
}

/// Cross-section of a piece's terms at any angle, even outside of the piece. `sine` is that of the grazing
/// angle.
template <class N>
N cross_section_in(const ScatteringModel::Piece& piece, const N& incidence, const N& sine) {
  N sum;
  for (const ScatteringModel::Term& t : piece.terms) {
    N value = N(t.level) * power_of(sine, t.power);
    if (t.slope != 0 || t.curvature != 0)
      value = value * exp(N(t.slope) * (incidence - N(piece.from)) - N(t.curvature) * squared(incidence));
    sum += value;
  }
  return sum;
}

/// Cross-section of the whole model over the angles of incidence that `incidence` encloses.
template <class N>
N cross_section_over(const ScatteringModel& model, const N& incidence, const N& sine) {
  constexpr bool balls = std::is_same_v<N, Ball>;
  double least = 0, most = 0;
  if constexpr (balls)
    least = incidence.lo(), most = incidence.hi();
  else
    least = incidence.lo, most = incidence.hi;
  const auto& pieces = model.pieces();
  N all;
  bool any = false;
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    if (most < pieces[k].from && k > 0) continue;
    if (least > pieces[k].to && k + 1 < pieces.size()) continue;
    const N own = cross_section_in(pieces[k], incidence, sine);
    if (!any)
      all = own;
    else if constexpr (balls)
      arb_union(all.get(), all.get(), own.get(), ball_bits);
    else
      all = hull(all, own);
    any = true;
  }
  return all;
}

}  // namespace tubefoot
