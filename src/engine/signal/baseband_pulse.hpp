// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <complex>
#include <cstddef>
#include <functional>
#include <vector>

namespace tubefoot {

/// What a receiver makes of a point at range 0: the complex envelope g about the carrier, with matched
/// filters and the like in it. With energy 1 (the integral of |g|^2), the integral of a signal's |y|^2 over
/// time is in the joules of energies.
struct BasebandPulse {
  std::function<std::complex<double>(double time_s)> envelope;
  double begin_s = 0, end_s = 0;  ///< it is 0 outside
  /// From the lowest to the highest frequency of the envelope; what it has beyond is an error of the
  /// covariances.
  double bandwidth_hz = 0;

  std::complex<double> at(double time_s) const {
    return time_s >= begin_s && time_s <= end_s ? envelope(time_s) : 0;
  }
};

/// exp(-t^2 / (2 sigma^2)), of energy 1, cut off in time and in frequency where it is `left_out` of its peak.
BasebandPulse gaussian_pulse(double sigma_s, double left_out = 1e-9);

/// The band within which a pulse's frequencies are, weighed by their amplitudes: twice the mean, of order
/// `order`, of |f|, (integral |G| |f|^order df / integral |G| df)^(1 / order) over the bandwidth, which is
/// not above it.
double weighed_bandwidth_hz(const BasebandPulse& pulse, int order);

/// The band B for which e(f) = min(tolerance |2 f / B|^order, 2), what interpolation of that order leaves of
/// a frequency f, comes to the tolerance: integral |G|^2 e^2 df = tolerance^2 integral |G|^2 df. Flanks that
/// are shorter than the bandwidth tells have tails beyond it, which are looked for as far as eight times as
/// far.
double resolved_bandwidth_hz(const BasebandPulse& pulse, int order, double tolerance);

/// When a receiver samples.
struct SignalTimes {
  double first_s = 0, rate_hz = 0;  ///< complex samples a second
  std::size_t count = 0;
  double time_s(std::size_t k) const { return first_s + double(k) / rate_hz; }
};

/// Throws std::invalid_argument, which says what is wrong and what to do, for pulses without extent or
/// bandwidth, for no sample, and for a bandwidth that the rate does not hold.
void check(const BasebandPulse& pulse, const SignalTimes& times);

/// A pulse at a sampling rate, at any fraction of a sample.
class PulseTable {
 public:
  PulseTable(const BasebandPulse& pulse, const SignalTimes& times);

  /// Adds amplitude g(t_k - delay) to out[k] of all samples.
  void add(std::complex<double> amplitude, double delay_s, std::complex<double>* out) const {
    // Samples t_k - delay = begin + (p + fraction) / rate, p = 0, 1, ...
    const double begin = (delay_s + begin_s_ - times_.first_s) * times_.rate_hz;
    if (!(begin < double(times_.count) && begin > -double(length_))) return;
    const double whole = std::ceil(begin), place = (whole - begin) * fractions;
    const auto row = std::size_t(place);
    const double above = place - double(row), below = 1 - above;
    const std::complex<double>*low = &rows_[row * length_], *high = low + length_;
    const auto first = std::ptrdiff_t(whole);
    const std::size_t from = first < 0 ? std::size_t(-first) : 0;
    const double re = amplitude.real(), im = amplitude.imag();
    for (std::size_t p = from; p < length_ && first + std::ptrdiff_t(p) < std::ptrdiff_t(times_.count); ++p) {
      const double x = below * low[p].real() + above * high[p].real(),
                   y = below * low[p].imag() + above * high[p].imag();
      std::complex<double>& sample = out[first + std::ptrdiff_t(p)];
      sample = {sample.real() + re * x - im * y, sample.imag() + re * y + im * x};
    }
  }
  std::size_t length() const { return length_; }

 private:
  static constexpr double fractions = 1024;  // of a sample; between them linearly, to 1e-6
  SignalTimes times_;
  double begin_s_;
  std::size_t length_;
  std::vector<std::complex<double>> rows_;
};

}  // namespace tubefoot
