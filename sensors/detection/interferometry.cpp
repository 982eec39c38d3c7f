// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/detection/interferometry.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace tubefoot {
namespace {

using std::numbers::pi;

constexpr double longest_baseline = 1e4;                              // in wavelengths
constexpr double slack = 1e-12;                                       // for a sine that rounding moves
                                                                      // beyond 1
constexpr double nothing_known_rad = pi / (2 * std::numbers::sqrt3);  // standard deviation of a uniform
                                                                      // angle over half a turn

}  // namespace

void InterferometricSample::add(double energy_j, double path_difference_m, double wavelength_m) {
  if (!(energy_j >= 0 && std::isfinite(energy_j) && std::isfinite(path_difference_m) && wavelength_m > 0))
    throw std::invalid_argument(
        fmt::format("interferometry: invalid path: {} J/m2, path difference {} m, wavelength {} m", energy_j,
                    path_difference_m, wavelength_m));
  upper_j += energy_j;
  lower_j += energy_j;
  cross_j += std::polar(energy_j, 2 * pi * std::remainder(path_difference_m / wavelength_m, 1.0));
}

void InterferometricSample::add_noise(double upper_noise_j, double lower_noise_j) {
  if (!(upper_noise_j >= 0 && lower_noise_j >= 0 && std::isfinite(upper_noise_j + lower_noise_j)))
    throw std::invalid_argument(fmt::format(
        "interferometry: the noise energies are {} and {} J/m2, but must be finite and not negative",
        upper_noise_j, lower_noise_j));
  upper_j += upper_noise_j;
  lower_j += lower_noise_j;
}

std::optional<double> InterferometricSample::phase_rad() const {
  if (cross_j == 0.0) return std::nullopt;
  return wrapped(std::arg(cross_j));
}

double InterferometricSample::coherence() const {
  const double mean = std::sqrt(upper_j) * std::sqrt(lower_j);
  return mean > 0 ? std::min(1.0, std::abs(cross_j) / mean) : 0;
}

double wrapped(double phase_rad) {
  const double phase = std::remainder(phase_rad, 2 * pi);
  return phase <= -pi ? pi : phase;
}

Interferometer::Interferometer(double baseline_m, double wavelength_m, double tilt_rad)
    : turn_(2 * pi * baseline_m / wavelength_m), tilt_rad_(tilt_rad) {
  if (!(wavelength_m > 0 && baseline_m > 0 && baseline_m <= longest_baseline * wavelength_m &&
        std::isfinite(wavelength_m) && std::isfinite(tilt_rad)))
    throw std::invalid_argument(
        fmt::format("interferometry: invalid geometry: baseline {} m, wavelength {} m, tilt {} rad",
                    baseline_m, wavelength_m, tilt_rad));
}

double Interferometer::sine(double angle_rad) const { return std::sin(angle_rad - tilt_rad_); }

std::vector<double> Interferometer::angles(double phase_rad) const {
  const double turns = turn_ / (2 * pi), phase_turns = wrapped(phase_rad) / (2 * pi);
  std::vector<double> found;
  for (double n = std::ceil(-turns - phase_turns - slack); n <= turns - phase_turns + slack; ++n)
    found.push_back(tilt_rad_ + std::asin(std::clamp((phase_turns + n) / turns, -1.0, 1.0)));
  return found;
}

double Interferometer::angle_near(double phase_rad, double expected_rad) const {
  const double expected = turn_ * sine(expected_rad), wrapped_phase = wrapped(phase_rad);
  double found = expected + std::remainder(phase_rad - expected, 2 * pi);
  if (std::abs(found) > turn_ * (1 + slack)) {  // one turn nearer to the middle, if a wave has that phase
    const double nearer = found - std::copysign(2 * pi, found);
    found = std::abs(nearer) <= turn_ * (1 + slack) ? nearer : wrapped_phase;
  }
  return tilt_rad_ + std::asin(std::clamp(found / turn_, -1.0, 1.0));
}

double Interferometer::angle_sigma(double angle_rad, double phase_sigma_rad) const {
  return std::min(phase_sigma_rad / (turn_ * std::abs(std::cos(angle_rad - tilt_rad_))), nothing_known_rad);
}

DepthEstimate Interferometer::point(double range_m, double angle_rad, double phase_sigma_rad) const {
  const double sigma = angle_sigma(angle_rad, phase_sigma_rad), across = range_m * std::cos(angle_rad);
  return {angle_rad, across, range_m * std::sin(angle_rad), sigma, std::abs(across) * sigma};
}

}  // namespace tubefoot
