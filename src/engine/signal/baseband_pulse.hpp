// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

// Defines the complex baseband envelope of a pulse, its effective bandwidths, and a table that adds delayed
// copies of it to sampled signals. Source: docs/notes/signals.md, "Pulses".

namespace tubefoot {

/// Time at which an envelope is not analytic. The analytic continuation from either side has an error on the
/// other side. The error x seconds from the break is at most step + bend x^2 / 2.
struct PulseBreak {
  double time_s = 0, step = 0, bend_per_s2 = 0;
};

/// Response of a receiver to a point at range 0: the complex envelope g about the carrier, including matched
/// filters. If the integral of |g|^2 is 1, the integral of |y|^2 of a signal over time has the unit of the
/// echo energies.
struct BasebandPulse {
  std::function<std::complex<double>(double time_s)> envelope;
  double begin_s = 0, end_s = 0;  ///< the envelope is 0 outside
  /// Difference between the highest and the lowest frequency of the envelope. Frequencies beyond this band
  /// become an error of the covariances.
  double bandwidth_hz = 0;
  /// Increasing times. Without a break the envelope counts as analytic.
  std::vector<PulseBreak> breaks{};
  /// Bandwidth of the parts between breaks, as bandwidth_hz. None: bandwidth_hz applies to them.
  std::optional<double> part_bandwidth_hz{};
  /// Shortest flank (half a period of a cosine) between two breaks, which part_bandwidth_hz excludes; 0: no
  /// flank.
  double flank_s = 0;
  /// Derivative of the envelope by time, per second. Only derivatives of signals need it.
  std::function<std::complex<double>(double time_s)> slope{};

  std::complex<double> at(double time_s) const {
    return time_s >= begin_s && time_s <= end_s ? envelope(time_s) : 0;
  }
  /// Returns the pulse whose envelope is the derivative of this envelope. Its flanks have kinks where this
  /// pulse has breaks.
  BasebandPulse rate() const;
};

/// exp(-t^2 / (2 sigma^2)) with energy 1, truncated in time and in frequency at `left_out` of its peak.
BasebandPulse gaussian_pulse(double sigma_s, double left_out = 1e-9);

/// Sets breaks and parts of a pulse with cosine flanks and a linear frequency sweep of `sweep_hz`. The two
/// flanks together take the fraction `taper` of the pulse length (0 to 1).
void set_flanks(BasebandPulse& pulse, double taper, double sweep_hz);

/// Effective bandwidth, weighted by the amplitudes of the spectrum G. It is twice the power mean of order
/// `order` of |f|: 2 (integral |G| |f|^order df / integral |G| df)^(1 / order) over the bandwidth. The
/// result is at most the bandwidth.
double weighed_bandwidth_hz(const BasebandPulse& pulse, int order);

/// Bandwidth B for which the root-mean-square interpolation error over the spectrum equals `tolerance`. The
/// error at a frequency is e(f) = min(tolerance |2 f / B|^order, 2). B fulfils integral |G|^2 e^2 df =
/// tolerance^2 integral |G|^2 df. The tails of the flanks are included as far as the breaks require, and
/// without breaks to eight times the bandwidth.
double resolved_bandwidth_hz(const BasebandPulse& pulse, int order, double tolerance);

/// Sampling times of a receiver.
struct SignalTimes {
  double first_s = 0, rate_hz = 0;  ///< rate: complex samples per second
  std::size_t count = 0;
  double time_s(std::size_t k) const { return first_s + double(k) / rate_hz; }
};

/// Throws std::invalid_argument, with the cause and a remedy. The cases are a pulse without extent or
/// bandwidth, no sample, and a sampling rate below the bandwidth.
void check(const BasebandPulse& pulse, const SignalTimes& times);

/// Table of a pulse at a sampling rate, for delays of any fraction of a sample.
class PulseTable {
 public:
  /// `tolerance`: error of interpolated values, relative to the largest modulus of the pulse. The values
  /// meet it except within reach_s() of a break. There the error is that of a shift in time of this size.
  PulseTable(const BasebandPulse& pulse, const SignalTimes& times, double tolerance = 1e-3);

  /// Adds amplitude * g(t_k - delay) to out[k] of all samples, or of the samples from `from` to before
  /// `end`.
  void add(std::complex<double> amplitude, double delay_s, std::complex<double>* out) const {
    add(amplitude, delay_s, 0, times_.count, out);
  }
  void add(std::complex<double> amplitude, double delay_s, std::size_t from, std::size_t end,
           std::complex<double>* out) const {
    // Sample times: t_k - delay = begin + (p + fraction) / rate with p = 0, 1, ...
    const double begin = (delay_s + begin_s_ - times_.first_s) * times_.rate_hz;
    if (!(begin < double(end) && begin > double(from) - double(length_))) return;
    const double whole = std::ceil(begin), place = (whole - begin) * fractions;
    const auto row = std::size_t(place);
    const double x = place - double(row);
    const std::complex<double>* value = &rows_[row * length_];
    const auto first = std::ptrdiff_t(whole), start = std::ptrdiff_t(from);
    const std::size_t p = first < start ? std::size_t(start - first) : 0;
    const auto last = std::ptrdiff_t(end) - first;
    // Values after the end of the pulse are 0, even if the pulse ends with a jump.
    const auto inside = std::ptrdiff_t(std::floor(end_ - place / fractions)) + 1;
    if (last <= 0 || inside <= 0) return;
    const auto count = std::size_t(std::min(inside, last));
    // Weights of the rows before, below, above and after this fraction.
    if (by_cubics_)
      add_rows<4>(amplitude, value,
                  {x * (x - 1) * (2 - x) / 6, (x + 1) * (x - 1) * (x - 2) / 2, (x + 1) * x * (2 - x) / 2,
                   (x + 1) * x * (x - 1) / 6},
                  p, count, out, first);
    else
      add_rows<2>(amplitude, value + length_, {1 - x, x}, p, count, out, first);
  }
  std::size_t length() const { return length_; }
  /// Largest modulus of the pulse.
  double peak() const { return peak_; }
  double reach_s() const { return 2 / (fractions * times_.rate_hz); }

 private:
  template <std::size_t Rows>
  void add_rows(std::complex<double> amplitude, const std::complex<double>* value,
                std::array<double, Rows> weight, std::size_t from, std::size_t end, std::complex<double>* out,
                std::ptrdiff_t first) const {
    const double re = amplitude.real(), im = amplitude.imag();
    for (std::size_t p = from; p < end; ++p) {
      double x = 0, y = 0;
      for (std::size_t r = 0; r < Rows; ++r) {
        x += weight[r] * value[r * length_ + p].real();
        y += weight[r] * value[r * length_ + p].imag();
      }
      std::complex<double>& sample = out[first + std::ptrdiff_t(p)];
      sample = {sample.real() + re * x - im * y, sample.imag() + re * y + im * x};
    }
  }

  static constexpr double fractions = 1024;  // of a sample; linear interpolation (error 1e-6) or cubics
                                             // between them
  SignalTimes times_;
  double begin_s_, end_, peak_ = 0;  // end in samples from the begin
  std::size_t length_;
  bool by_cubics_ = false;
  /// The first value lies a fraction before the begin of the pulse. Values outside of the pulse are analytic
  /// continuations.
  std::vector<std::complex<double>> rows_;
};

}  // namespace tubefoot
