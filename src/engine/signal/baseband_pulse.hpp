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

namespace tubefoot {

/// Where an envelope is not analytic: its continuation from either side is off what is on the other side, x
/// seconds on, by at most step + bend x^2 / 2.
struct PulseBreak {
  double time_s = 0, step = 0, bend_per_s2 = 0;
};

/// What a receiver makes of a point at range 0: the complex envelope g about the carrier, with matched
/// filters and the like in it. With energy 1 (the integral of |g|^2), the integral of a signal's |y|^2 over
/// time is in the joules of energies.
struct BasebandPulse {
  std::function<std::complex<double>(double time_s)> envelope;
  double begin_s = 0, end_s = 0;  ///< it is 0 outside
  /// From the lowest to the highest frequency of the envelope; what it has beyond is an error of the
  /// covariances.
  double bandwidth_hz = 0;
  /// Increasing; none: the envelope counts as analytic.
  std::vector<PulseBreak> breaks{};
  /// Of the parts between breaks, the same as bandwidth_hz; none: they have no more and no less than that.
  std::optional<double> part_bandwidth_hz{};
  /// The shortest flank between two breaks, half a period of a cosine, which the part's bandwidth does not
  /// count; 0: there is none.
  double flank_s = 0;

  std::complex<double> at(double time_s) const {
    return time_s >= begin_s && time_s <= end_s ? envelope(time_s) : 0;
  }
};

/// exp(-t^2 / (2 sigma^2)), of energy 1, cut off in time and in frequency where it is `left_out` of its peak.
BasebandPulse gaussian_pulse(double sigma_s, double left_out = 1e-9);

/// Breaks and parts of a pulse whose flanks are half periods of a cosine and take the share `taper` of its
/// length, 0 to 1, both together, and whose frequency goes evenly over `sweep_hz` meanwhile.
void set_flanks(BasebandPulse& pulse, double taper, double sweep_hz);

/// The band within which a pulse's frequencies are, weighed by their amplitudes: twice the mean, of order
/// `order`, of |f|, (integral |G| |f|^order df / integral |G| df)^(1 / order) over the bandwidth, which is
/// not above it.
double weighed_bandwidth_hz(const BasebandPulse& pulse, int order);

/// The band B for which e(f) = min(tolerance |2 f / B|^order, 2), what interpolation of that order leaves of
/// a frequency f, comes to the tolerance: integral |G|^2 e^2 df = tolerance^2 integral |G|^2 df. Flanks have
/// tails beyond the bandwidth: as far as the pulse's breaks tell, and without breaks eight times as far.
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
  /// `tolerance`: of values between those of the table, relative to the pulse's largest. Away from breaks
  /// they keep it; next to one, within reach_s(), they are off by what it makes of such a time.
  PulseTable(const BasebandPulse& pulse, const SignalTimes& times, double tolerance = 1e-3);

  /// Adds amplitude g(t_k - delay) to out[k] of all samples, or of those from `from` to before `end`.
  void add(std::complex<double> amplitude, double delay_s, std::complex<double>* out) const {
    add(amplitude, delay_s, 0, times_.count, out);
  }
  void add(std::complex<double> amplitude, double delay_s, std::size_t from, std::size_t end,
           std::complex<double>* out) const {
    // Samples t_k - delay = begin + (p + fraction) / rate, p = 0, 1, ...
    const double begin = (delay_s + begin_s_ - times_.first_s) * times_.rate_hz;
    if (!(begin < double(end) && begin > double(from) - double(length_))) return;
    const double whole = std::ceil(begin), place = (whole - begin) * fractions;
    const auto row = std::size_t(place);
    const double x = place - double(row);
    const std::complex<double>* value = &rows_[row * length_];
    const auto first = std::ptrdiff_t(whole), start = std::ptrdiff_t(from);
    const std::size_t p = first < start ? std::size_t(start - first) : 0;
    const auto last = std::ptrdiff_t(end) - first;
    // Nothing is left after the pulse's end, though it may jump there.
    const auto inside = std::ptrdiff_t(std::floor(end_ - place / fractions)) + 1;
    if (last <= 0 || inside <= 0) return;
    const auto count = std::size_t(std::min(inside, last));
    // At this fraction the rows before, below, above and after it count so much.
    if (by_cubics_)
      add_rows<4>(amplitude, value,
                  {x * (x - 1) * (2 - x) / 6, (x + 1) * (x - 1) * (x - 2) / 2, (x + 1) * x * (2 - x) / 2,
                   (x + 1) * x * (x - 1) / 6},
                  p, count, out, first);
    else
      add_rows<2>(amplitude, value + length_, {1 - x, x}, p, count, out, first);
  }
  std::size_t length() const { return length_; }
  /// The pulse's largest modulus.
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

  static constexpr double fractions = 1024;  // of a sample; between them linearly, to 1e-6, or by cubics
  SignalTimes times_;
  double begin_s_, end_, peak_ = 0;  // the end in samples after the begin
  std::size_t length_;
  bool by_cubics_ = false;
  /// The first is a fraction before the pulse's begin. Values outside of the pulse are continuations.
  std::vector<std::complex<double>> rows_;
};

}  // namespace tubefoot
