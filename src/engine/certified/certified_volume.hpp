// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/numbers/ball.hpp"

#if __has_include(<flint/acb_hypgeom.h>)
#include <flint/acb_hypgeom.h>
#else
#include <acb_hypgeom.h>
#endif

// The range function of volume reverberation in ball arithmetic. Include this heavy header only in .cpp files
// and in headers of integrators.
namespace tubefoot {

/// Returns the exponential integral E1(x) for a positive real part; otherwise a value that is not finite.
inline ComplexBall exponential_integral(const ComplexBall& x) {
  ComplexBall result;
  const ComplexBall order(1.0);
  if (x.is_finite() && x.real().surely_positive())
    acb_hypgeom_expint(result.get(), order.get(), x.get(), ball_bits);
  else
    acb_indeterminate(result.get());
  return result;
}
inline Ball exponential_integral(const Ball& x) { return exponential_integral(ComplexBall(x)).real(); }

/// Returns F(r), a primitive of r^-2 e^(-2 beta r): F(r) = 2 beta E1(2 beta r) - e^(-2 beta r) / r.
template <class N>
N volume_primitive(const N& r, const Ball& beta_per_m) {
  if (!beta_per_m.surely_positive()) return N(Ball(-1)) / r;
  const N twice(beta_per_m + beta_per_m), x = twice * r;
  return twice * exponential_integral(x) - exp(-x) / r;
}

}  // namespace tubefoot
