// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/receiver/phase_noise.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace tubefoot {
namespace {

using std::numbers::pi;

void check(double coherence) {
  if (!(coherence >= 0 && coherence <= 1))
    throw std::invalid_argument(
        fmt::format("phase noise: the coherence is {}, but must be 0 to 1", coherence));
}

/// b = g cos phi, sqrt(1 - b^2) without cancellation, and acos(-b) from both.
struct Terms {
  double incoherence, b, root, angle;
  Terms(double phase, double g) : incoherence((1 - g) * (1 + g)), b(g * std::cos(phase)) {
    const double sine = g * std::sin(phase);
    root = std::sqrt(incoherence + sine * sine);
    angle = std::atan2(root, -b);
  }
};

/// Probability of a phase between 0 and this one.
double from_zero(double phase, double g) {
  const Terms terms(phase, g);
  return (phase + g * std::sin(phase) * terms.angle / terms.root) / (2 * pi);
}

/// Dilogarithm, the sum of x^k / k^2, for 0 <= x <= 1/2.
double dilogarithm(double x) {
  double sum = 0, power = x;
  for (int k = 1; power > 1e-18 * x; ++k, power *= x) sum += power / (k * k);
  return sum;
}

double single_look_variance(double g) {
  // pi^2/3 - pi asin g + asin^2 g = acos^2 g + pi^2/12. By Euler's reflection the rest, (pi^2/6 - Li2(g^2))
  // / 2, is (Li2(1 - g^2) + log(g^2) log(1 - g^2)) / 2. Its terms are positive and do not cancel near g = 1.
  const double incoherence = (1 - g) * (1 + g), square = g * g;
  const double angle = std::atan2(std::sqrt(incoherence), g);  // acos g
  if (incoherence == 0) return 0;
  if (square <= 0.5) return angle * angle + (pi * pi / 6 - dilogarithm(square)) / 2;
  return angle * angle + (dilogarithm(incoherence) + std::log1p(-incoherence) * std::log(incoherence)) / 2;
}

}  // namespace

double phase_density(double phase_rad, double coherence) {
  check(coherence);
  if (coherence == 1)
    throw std::invalid_argument("phase noise: at a coherence of 1, the phase has no probability density");
  const Terms terms(phase_rad, coherence);
  return terms.incoherence / (2 * pi * terms.root * terms.root) * (1 + terms.b * terms.angle / terms.root);
}

double phase_distribution(double phase_rad, double coherence) {
  check(coherence);
  if (coherence == 1) return phase_rad < 0 ? 0 : 1;
  return 0.5 + from_zero(phase_rad, coherence);
}

double phase_variance(double coherence, int looks) {
  check(coherence);
  if (looks < 1)
    throw std::invalid_argument(
        fmt::format("phase noise: the number of looks is {}, but must be 1 or more", looks));
  const double single = single_look_variance(coherence);
  if (looks == 1 || coherence == 0) return single;
  return std::min(single, (1 - coherence) * (1 + coherence) / (2.0 * looks * coherence * coherence));
}

double draw_phase_error(const SampleRandom& random, double coherence) {
  check(coherence);
  if (coherence == 1) return 0;
  const double uniform = random.uniform_pair(Purpose::phase)[0] - 0.5;  // exact, never 0
  const auto excess = [&](double phase) { return from_zero(phase, coherence) - std::abs(uniform); };
  const double most = excess(pi);
  if (most <= 0) return std::copysign(pi, uniform);  // the last 1e-16 of the probability
  std::uintmax_t steps = 200;
  const auto [low, high] = boost::math::tools::toms748_solve(
      excess, 0.0, pi, -std::abs(uniform), most, boost::math::tools::eps_tolerance<double>(48), steps);
  return std::copysign((low + high) / 2, uniform);
}

}  // namespace tubefoot
