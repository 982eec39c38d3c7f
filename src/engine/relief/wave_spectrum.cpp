// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/relief/wave_spectrum.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

// Wave heights are rounded to the grid of the scene. Numbers of this file are long double until the end, so
// that all x86 machines compute the same ones (see engine/relief/fourier.hpp).

namespace tubefoot {
namespace {

using Real = long double;

constexpr Real gravity = standard_gravity_m_s2;

void require_above_0(double value, const char* message) {
  if (!(value > 0 && std::isfinite(value))) throw std::invalid_argument(message);
}

/// Returns the integral of a function that is smooth in the logarithm of x. Gauss quadrature has five nodes
/// per panel of a thirtieth of a natural unit.
template <class Function>
Real integral_over_logarithm(Real lo, Real hi, const Function& function) {
  if (!(hi > lo)) return 0;
  constexpr std::array<Real, 3> nodes{0.0L, 0.53846931010568309104L, 0.90617984593866399280L},
      weights{0.56888888888888888889L, 0.47862867049936646804L, 0.23692688505618908751L};
  const Real length = std::log(hi / lo);
  const int panels = static_cast<int>(std::ceil(30 * length));
  Real sum = 0;
  for (int k = 0; k < panels; ++k) {
    const Real half = length / (2 * panels), middle = (2 * k + 1) * half;
    for (std::size_t n = 0; n < nodes.size(); ++n)
      for (const int side : {-1, 1}) {
        if (n == 0 && side > 0) continue;
        const Real x = lo * std::exp(middle + side * half * nodes[n]);
        sum += half * weights[n] * function(x) * x;
      }
  }
  return sum;
}

}  // namespace

WaveSpectrum WaveSpectrum::pierson_moskowitz(double wind_speed_m_s) {
  require_above_0(wind_speed_m_s, "a wave spectrum needs a wind speed above 0");
  constexpr Real beta = 0.74L, from_10_to_19_5_m = 1.026L;
  WaveSpectrum spectrum;
  spectrum.alpha_ = 0.0081;
  spectrum.peak_rad_s_ =
      static_cast<double>(std::sqrt(std::sqrt(0.8L * beta)) * gravity / (from_10_to_19_5_m * wind_speed_m_s));
  return spectrum;
}

WaveSpectrum WaveSpectrum::jonswap(double wind_speed_m_s, double fetch_m) {
  require_above_0(wind_speed_m_s, "a wave spectrum needs a wind speed above 0");
  require_above_0(fetch_m, "a wave spectrum needs a fetch above 0");
  const Real wind = wind_speed_m_s, fetch = fetch_m;
  WaveSpectrum spectrum;
  spectrum.alpha_ = static_cast<double>(0.076L * std::pow(wind * wind / (gravity * fetch), 0.22L));
  spectrum.peak_rad_s_ = static_cast<double>(22 * std::pow(gravity * gravity / (wind * fetch), Real(1) / 3));
  spectrum.peak_ = 3.3;
  return spectrum;
}

double WaveSpectrum::density(double frequency_rad_s) const {
  const Real w = frequency_rad_s, peak = peak_rad_s_, ratio = peak / w;
  Real value =
      alpha_ * gravity * gravity / (w * w * w * w * w) * std::exp(-1.25L * ratio * ratio * ratio * ratio);
  if (peak_ != 1) {
    const Real width = w > peak ? 0.09L : 0.07L, off = (w - peak) / (width * peak);
    value *= std::pow(static_cast<Real>(peak_), std::exp(-off * off / 2));
  }
  return static_cast<double>(value);
}

double WaveSpectrum::variance_m2(double lo_rad_s, double hi_rad_s) const {
  const auto below = [&](double w) {  // of a spectrum whose peak is not raised
    if (!(w > 0)) return Real(0);
    const Real ratio = peak_rad_s_ / static_cast<Real>(w), peak = peak_rad_s_;
    return alpha_ * gravity * gravity / (5 * peak * peak * peak * peak) *
           std::exp(-1.25L * ratio * ratio * ratio * ratio);
  };
  if (!(hi_rad_s > lo_rad_s)) return 0;
  if (peak_ == 1) return static_cast<double>(below(hi_rad_s) - below(lo_rad_s));
  // Beyond these frequencies the peak has no effect on the last digit.
  const double lo = std::clamp(lo_rad_s, 0.15 * peak_rad_s_, 3 * peak_rad_s_),
               hi = std::clamp(hi_rad_s, 0.15 * peak_rad_s_, 3 * peak_rad_s_),
               tail = std::max(lo_rad_s, 3 * peak_rad_s_);
  Real sum = hi_rad_s > tail ? below(hi_rad_s) - below(tail) : 0;
  const auto density_at = [&](Real w) { return static_cast<Real>(density(static_cast<double>(w))); };
  const double middle = std::clamp(peak_rad_s_, lo, hi);  // where the width changes
  sum += integral_over_logarithm(lo, middle, density_at) + integral_over_logarithm(middle, hi, density_at);
  return static_cast<double>(sum);
}

double WaveSpectrum::slope_variance(double lo_rad_s, double hi_rad_s) const {
  const double lo = std::max(lo_rad_s, 0.15 * peak_rad_s_), middle = std::clamp(peak_rad_s_, lo, hi_rad_s);
  if (!(hi_rad_s > lo)) return 0;
  const auto slope_at = [&](Real w) {
    const Real k = w * w / gravity;
    return k * k * density(static_cast<double>(w));
  };
  return static_cast<double>(integral_over_logarithm(lo, middle, slope_at) +
                             integral_over_logarithm(middle, hi_rad_s, slope_at));
}

double WaveSpectrum::significant_height_m() const {
  return 4 * std::sqrt(variance_m2(0, std::numeric_limits<double>::infinity()));
}

double deep_water_frequency(double wavelength_m) {
  return std::sqrt(standard_gravity_m_s2 * 2 * std::numbers::pi / wavelength_m);
}

}  // namespace tubefoot
