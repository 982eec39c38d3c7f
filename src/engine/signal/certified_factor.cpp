// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/signal/certified_factor.hpp"

#include <algorithm>
#include <cmath>

namespace tubefoot {
namespace {

/// Square root with non-negative real part of a number with non-negative imaginary part. On the branch cut
/// (imaginary part 0, negative real part) the result is the limit from above.
ComplexBall upper_root(const ComplexBall& z) {
  const Ball real = z.real();
  if (z.imaginary().surely_positive() || real.surely_positive()) return root(z);
  const double most = std::max(real.hi(), 0.0), least = std::min(real.lo(), 0.0);
  if (z.imaginary().lo() == 0 && z.imaginary().hi() == 0) {
    if (real.surely_negative()) return {Ball(0.0), root(-real)};
    return {Ball::between(0, root(Ball(most)).hi()), Ball::between(0, root(Ball(-least)).hi())};
  }
  // The number may be close to 0. The root's modulus is at most the root of the largest modulus.
  const double size = root(Ball(z.largest())).hi();
  return {Ball::between(0, size), Ball::between(0, size)};
}

ComplexBall fluid_factor(const FluidSediment& seabed, const Ball& sine) {
  const Ball cosine2 = Ball(1.0) - squared(sine), loss(seabed.loss);
  // Squared slowness relative to the water: (1 + i loss)^2 / speed_ratio^2.
  const Ball over = squared(Ball(seabed.speed_ratio));
  const ComplexBall square((Ball(1.0) - squared(loss)) / over, Ball(2.0) * loss / over);
  const ComplexBall p = upper_root(square - ComplexBall(cosine2)), across(Ball(seabed.density_ratio) * sine);
  const ComplexBall factor = (across - p) / (across + p);
  if (!factor.is_finite() || factor.largest() > 1.5)  // unbounded sine, or grazing incidence on a fluid like
                                                      // water
    return {Ball::between(-1, 1), Ball::between(-1, 1)};
  return factor;
}

}  // namespace

ComplexBall certified_factor(const SmoothSurface& surface, const Ball& sine, const Ball& wave_number) {
  const ComplexBall mirror =
      surface.fluid ? fluid_factor(*surface.fluid, sine)
                    : ComplexBall(Ball(surface.reflection.real()), Ball(surface.reflection.imag()));
  if (surface.roughness_m == 0) return mirror;
  const Ball change = Ball(2.0) * wave_number * sine * Ball(surface.roughness_m);
  return mirror * ComplexBall(exp(-(squared(change) / Ball(2.0))));
}

}  // namespace tubefoot
