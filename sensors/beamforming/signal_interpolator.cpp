// SPDX-License-Identifier: GPL-3.0-or-later
// Interpolates sampled signals with a sinc kernel under a Kaiser window. Kaiser's formula (1974) gives the
// number of taps from the band and the error; a table over phases with cubic interpolation gives the kernel.

#include "sensors/beamforming/signal_interpolator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace tubefoot {
namespace {

using Complex = std::complex<double>;
using std::numbers::pi;

// Number of tabulated phases. A cubic through four phases is within 4e-11 of the kernel.
constexpr int phases = 512;
constexpr std::size_t most_taps = 512;

/// Modified Bessel function of order 0 by its series, to the last bits for the arguments of Kaiser windows.
double bessel_i0(double x) {
  double term = 1, sum = 1;
  for (int k = 1; term > 1e-17 * sum; ++k) {
    term *= x * x / (4.0 * k * k);
    sum += term;
  }
  return sum;
}

double sinc(double x) { return x == 0 ? 1 : std::sin(pi * x) / (pi * x); }

struct KaiserDesign {
  std::size_t taps;
  double shape;
};

KaiserDesign design(double band, double error) {
  // The pass band and several images of the stop band add errors, so that the design uses a quarter of the
  // error.
  const double down_db = -20 * std::log10(error / 4), transition_rad = 2 * pi * (1 - band);
  const double shape = down_db > 50   ? 0.1102 * (down_db - 8.7)
                       : down_db > 21 ? 0.5842 * std::pow(down_db - 21, 0.4) + 0.07886 * (down_db - 21)
                                      : 0;
  const double needed = std::max(2.0, (down_db - 7.95) / (2.285 * transition_rad) + 1);
  return {2 * static_cast<std::size_t>(std::ceil(needed / 2)), shape};
}

}  // namespace

SignalInterpolator::SignalInterpolator(double band, double error) : band_(band), error_(error) {
  if (!(band > 0 && band < 1))
    throw std::invalid_argument(
        fmt::format("the band of the interpolator is {} times half the sampling rate, but this factor must "
                    "be above 0 and below 1: increase the sampling rate",
                    band));
  if (!(error >= 1e-9 && error < 0.5))
    throw std::invalid_argument(
        fmt::format("the error of the interpolator is {}, but must be at least 1e-9 and below 0.5", error));
  const auto [taps, shape] = design(band, error);
  if (taps > most_taps)
    throw std::invalid_argument(
        fmt::format("an interpolator for a band of {} times half the sampling rate with an error of {} needs "
                    "{} taps, but the limit is {}: increase the sampling rate, or permit a larger error",
                    band, error, taps, most_taps));
  taps_ = taps;
  const double half = 0.5 * static_cast<double>(taps);
  for (int phase = -1; phase <= phases + 1; ++phase)
    for (std::size_t tap = 0; tap < taps; ++tap) {
      const double distance = static_cast<double>(tap) + 1 - half - static_cast<double>(phase) / phases;
      const double inside = 1 - distance * distance / (half * half);
      table_.push_back(inside < 0 ? 0
                                  : sinc(distance) * bessel_i0(shape * std::sqrt(inside)) / bessel_i0(shape));
    }
}

void SignalInterpolator::weights(double fraction, double* into) const {
  const double fine = fraction * phases;
  const int phase = std::min(static_cast<int>(fine), phases - 1);
  const double x = fine - phase;
  // Lagrange's cubic through one phase before the position, the phase at it, and two phases after it.
  const std::array<double, 4> cubic{-x * (x - 1) * (x - 2) / 6, (x + 1) * (x - 1) * (x - 2) / 2,
                                    -(x + 1) * x * (x - 2) / 2, (x + 1) * x * (x - 1) / 6};
  const double* rows = table_.data() + static_cast<std::size_t>(phase) * taps_;
  for (std::size_t tap = 0; tap < taps_; ++tap)
    into[tap] = cubic[0] * rows[tap] + cubic[1] * rows[tap + taps_] + cubic[2] * rows[tap + 2 * taps_] +
                cubic[3] * rows[tap + 3 * taps_];
}

Complex SignalInterpolator::at(std::span<const Complex> signal, double position) const {
  const auto count = static_cast<std::ptrdiff_t>(signal.size()), taps = static_cast<std::ptrdiff_t>(taps_);
  if (!(position > static_cast<double>(-taps) && position < static_cast<double>(count + taps))) return 0;
  const double whole = std::floor(position);
  std::array<double, most_taps> weight;
  weights(position - whole, weight.data());
  const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(whole) + 1 - taps / 2;
  double real = 0, imaginary = 0;
  const std::ptrdiff_t begin = std::max<std::ptrdiff_t>(0, -first), end = std::min(taps, count - first);
  for (std::ptrdiff_t tap = begin; tap < end; ++tap) {
    const Complex& sample = signal[static_cast<std::size_t>(first + tap)];
    real += weight[static_cast<std::size_t>(tap)] * sample.real();
    imaginary += weight[static_cast<std::size_t>(tap)] * sample.imag();
  }
  return {real, imaginary};
}

void SignalInterpolator::add_shifted(std::span<const Complex> signal, double shift, Complex factor,
                                     std::span<Complex> out) const {
  const auto count = static_cast<std::ptrdiff_t>(signal.size()), taps = static_cast<std::ptrdiff_t>(taps_),
             outputs = static_cast<std::ptrdiff_t>(out.size());
  if (!(std::abs(shift) < static_cast<double>(count + outputs + taps))) return;
  const double whole = std::floor(shift);
  std::array<double, most_taps> weight;
  weights(shift - whole, weight.data());
  const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(whole) + 1 - taps / 2;
  for (std::ptrdiff_t k = 0; k < outputs; ++k) {
    double real = 0, imaginary = 0;
    const std::ptrdiff_t from = k + first, begin = std::max<std::ptrdiff_t>(0, -from),
                         end = std::min(taps, count - from);
    for (std::ptrdiff_t tap = begin; tap < end; ++tap) {
      const Complex& sample = signal[static_cast<std::size_t>(from + tap)];
      real += weight[static_cast<std::size_t>(tap)] * sample.real();
      imaginary += weight[static_cast<std::size_t>(tap)] * sample.imag();
    }
    out[static_cast<std::size_t>(k)] += factor * Complex(real, imaginary);
  }
}

void SignalInterpolator::check_holds(const TransmitWaveform& waveform, const SignalSampling& sampling) const {
  const double farthest_hz = std::max(std::abs(waveform.start_hz - sampling.baseband_hz),
                                      std::abs(waveform.stop_hz - sampling.baseband_hz));
  if (farthest_hz <= band_ * sampling.rate_hz / 2) return;
  throw std::invalid_argument(fmt::format(
      "the waveform extends {} Hz from the baseband frequency, but the interpolator covers only {:g} times "
      "half the sampling rate, which is {} Hz: sample at {:g} Hz or more, or use a wider band",
      farthest_hz, band_, band_ * sampling.rate_hz / 2, 2 * farthest_hz / band_));
}

}  // namespace tubefoot
