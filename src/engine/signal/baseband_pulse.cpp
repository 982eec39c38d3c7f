// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/signal/baseband_pulse.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "engine/relief/fourier.hpp"

// Computes effective bandwidths of pulses from their spectra and from the jumps of their derivatives, and
// fills the table of delayed pulses. Source: docs/notes/signals.md, "Pulses" and "Element signals".

namespace tubefoot {

BasebandPulse gaussian_pulse(double sigma_s, double left_out) {
  if (!(sigma_s > 0 && left_out > 0 && left_out < 1))
    throw std::invalid_argument(
        fmt::format("a Gaussian pulse needs a length above 0 and an omitted share below 1, not {} s and {}",
                    sigma_s, left_out));
  const double reach = std::sqrt(-2 * std::log(left_out)),
               peak = 1 / std::sqrt(sigma_s * std::sqrt(std::numbers::pi)), square = sigma_s * sigma_s;
  BasebandPulse pulse{[=](double t) { return std::complex<double>(peak * std::exp(-t * t / (2 * square))); },
                      -reach * sigma_s, reach * sigma_s, reach / (std::numbers::pi * sigma_s)};
  pulse.slope = [=, envelope = pulse.envelope](double t) { return -t / square * envelope(t); };
  return pulse;
}

BasebandPulse BasebandPulse::rate() const {
  BasebandPulse rate = *this;
  rate.envelope = slope;
  rate.slope = nullptr;
  return rate;
}

void set_flanks(BasebandPulse& pulse, double taper, double sweep_hz) {
  const double length_s = pulse.end_s - pulse.begin_s, flank_s = taper * length_s / 2,
               height = std::abs(pulse.at((pulse.begin_s + pulse.end_s) / 2)), pi = std::numbers::pi;
  // Near its foot a flank is height (1 - cos(pi x / flank)) / 2, and near its top the height minus this
  // value.
  const double step = flank_s > 0 ? 0 : height,
               bend = flank_s > 0 ? height / 2 * std::pow(pi / flank_s, 2) : 0;
  pulse.breaks = {{pulse.begin_s, step, bend}};
  if (flank_s > 0 && taper < 1) {
    pulse.breaks.push_back({pulse.begin_s + flank_s, 0, bend});
    pulse.breaks.push_back({pulse.end_s - flank_s, 0, bend});
  }
  pulse.breaks.push_back({pulse.end_s, step, bend});
  pulse.flank_s = flank_s;
  // Derivatives of e^{i a t^2} of order n, with a = pi sweep / length, are at most about sqrt(2 n a / e)^n.
  // For the orders of the polynomials this corresponds to an angular frequency of 3 sqrt(a).
  pulse.part_bandwidth_hz = std::abs(sweep_hz) + 3 * std::sqrt(std::abs(sweep_hz) / length_s / pi);
}

namespace {

/// Energy beyond a frequency, for both signs, that comes from breaks. Their amplitudes are step / (2 pi f)
/// and bend / (2 pi f)^3. The energies of several breaks are added.
struct Tail {
  double of_steps = 0, of_bends = 0;

  explicit Tail(const BasebandPulse& pulse) {
    constexpr double turn = 2 * std::numbers::pi;
    for (const PulseBreak& at : pulse.breaks) {
      of_steps += 2 * std::pow(at.step / turn, 2);
      of_bends += 2 * std::pow(at.bend_per_s2 / (turn * turn * turn), 2) / 5;
    }
  }
  /// Frequency beyond which less than the given energy remains.
  double frequency_of(double energy) const {
    return std::max(2 * of_steps / energy, std::pow(2 * of_bends / energy, 0.2));
  }
};

}  // namespace

double weighed_bandwidth_hz(const BasebandPulse& pulse, int order) {
  constexpr int frequencies = 128;
  // Four times the sampling rate of the band, so that aliases lie far from the band.
  const double half = pulse.bandwidth_hz / 2, interval = 1 / (4 * pulse.bandwidth_hz);
  const int count = int(std::ceil((pulse.end_s - pulse.begin_s) / interval)) + 1;
  std::vector<std::complex<double>> values;
  for (int k = 0; k < count; ++k) values.push_back(pulse.at(pulse.begin_s + k * interval));
  double sum = 0, weighed = 0;
  for (int n = 0; n < frequencies; ++n) {
    const double share = (2 * n + 1.0) / frequencies - 1,
                 turn = 2 * std::numbers::pi * share * half * interval;
    std::complex<double> amplitude = 0, phase = 1;
    const std::complex<double> step = std::polar(1.0, turn);
    for (const std::complex<double>& value : values) {
      amplitude += value * phase;
      phase *= step;
    }
    sum += std::abs(amplitude);
    weighed += std::abs(amplitude) * std::pow(std::abs(share), order);
  }
  return sum > 0 ? 2 * half * std::pow(weighed / sum, 1.0 / order) : pulse.bandwidth_hz;
}

double resolved_bandwidth_hz(const BasebandPulse& pulse, int order, double tolerance) {
  constexpr double farthest = 8;   // in halves of the bandwidth, without breaks
  constexpr double margin = 1.25;  // keeps aliases outside of the evaluated band
  constexpr double beyond = 0.1;   // share of the permitted error for frequencies beyond the evaluated band
  constexpr std::size_t least_samples = 1024, most_samples = std::size_t(1) << 20;
  const double most = 4 / (tolerance * tolerance), length_s = pulse.end_s - pulse.begin_s;
  double tail_hz = 0;
  if (!pulse.breaks.empty()) {
    constexpr int parts = 4096;
    double energy = 0;
    for (int n = 0; n < parts; ++n)
      energy += std::norm(pulse.at(pulse.begin_s + (n + 0.5) / parts * length_s)) * length_s / parts;
    if (energy > 0) tail_hz = Tail(pulse).frequency_of(beyond * energy / most);
    // The tails surround the band of the parts.
    tail_hz += pulse.part_bandwidth_hz.value_or(pulse.bandwidth_hz) / 2;
  }
  const double reach_hz = std::max(farthest * pulse.bandwidth_hz / 2, tail_hz),
               rate_hz = 2 * margin * reach_hz;
  // Pulse with steps, whose tails are too long for a transform: the band resolves all except the permitted
  // rest.
  if (tail_hz == reach_hz && length_s * rate_hz > double(most_samples))
    return 2 * tail_hz * std::pow(most, -0.5 / order);
  const auto held = std::size_t(std::ceil(length_s * rate_hz)) + 1;
  const std::size_t count = std::bit_ceil(std::max(2 * held, least_samples));
  std::vector<std::complex<long double>> spectrum(count);
  for (std::size_t k = 0; k < held; ++k) spectrum[k] = pulse.at(pulse.begin_s + double(k) / rate_hz);
  InverseTransforms(count).column(spectrum.data());
  const auto energy = [&](std::size_t n) { return std::norm(std::complex<double>(spectrum[n])); };
  std::vector<double> energies{energy(0)};  // sums of f and -f
  for (std::size_t n = 1; n < count / 2 && double(n) / double(count) * rate_hz <= reach_hz; ++n)
    energies.push_back(energy(n) + energy(count - n));
  const double all = std::reduce(energies.begin(), energies.end());
  if (!(all > 0)) return pulse.bandwidth_hz;
  const double step = rate_hz / double(count);
  const auto resolves = [&](double band_hz) {
    double sum = 0;
    for (std::size_t n = 0; n < energies.size(); ++n)
      sum += energies[n] * std::min(std::pow(2 * double(n) * step / band_hz, 2 * order), most);
    return sum <= all;
  };
  double low = 0, high = 2 * reach_hz;
  for (int halving = 0; halving < 20; ++halving) (resolves((low + high) / 2) ? high : low) = (low + high) / 2;
  return high;
}

void check(const BasebandPulse& pulse, const SignalTimes& times) {
  if (!pulse.envelope || !(pulse.end_s > pulse.begin_s) || !(pulse.bandwidth_hz > 0) ||
      !std::isfinite(pulse.end_s - pulse.begin_s) || !std::isfinite(pulse.bandwidth_hz))
    throw std::invalid_argument(
        fmt::format("a pulse needs an envelope, an end after its start and a bandwidth above 0, not {} s to "
                    "{} s and {} Hz",
                    pulse.begin_s, pulse.end_s, pulse.bandwidth_hz));
  if (times.count < 1 || !(times.rate_hz > 0) || !std::isfinite(times.rate_hz) ||
      !std::isfinite(times.first_s))
    throw std::invalid_argument(
        fmt::format("a receiver needs a sampling rate above 0 and at least one sample, not {} Hz and {}",
                    times.rate_hz, times.count));
  if (pulse.bandwidth_hz > times.rate_hz)
    throw std::invalid_argument(
        fmt::format("a bandwidth of {} Hz does not fit into {} complex samples per second: increase the "
                    "sampling rate, or filter the pulse",
                    pulse.bandwidth_hz, times.rate_hz));
}

PulseTable::PulseTable(const BasebandPulse& pulse, const SignalTimes& times, double tolerance)
    : times_(times),
      begin_s_(pulse.begin_s),
      end_((pulse.end_s - pulse.begin_s) * times.rate_hz),
      length_(std::size_t(std::ceil(end_)) + 1) {
  const auto rows = std::size_t(fractions) + 4;
  rows_.resize(rows * length_);
  // Rows contain values at fractions of a sample, from the begin on.
  const auto last = std::ptrdiff_t(std::floor(end_ * fractions));
  const auto inside = [&](std::ptrdiff_t m) {
    return pulse.at(std::min(pulse.begin_s + double(m) / (fractions * times.rate_hz), pulse.end_s));
  };
  const auto at = [&](std::ptrdiff_t m) -> std::complex<double> {
    if (m >= 0 && m <= last) return inside(m);
    // Next to the ends, cubics extrapolate.
    const std::ptrdiff_t from = m < 0 ? 0 : last, step = m < 0 ? 1 : -1, over = m < 0 ? -m : m - last;
    if (last < 3 || over > 2) return 0;
    const auto v0 = inside(from), v1 = inside(from + step), v2 = inside(from + 2 * step),
               v3 = inside(from + 3 * step), next = 4.0 * v0 - 6.0 * v1 + 4.0 * v2 - v3;
    return over == 1 ? next : 4.0 * next - 6.0 * v0 + 4.0 * v1 - v2;
  };
  const auto fine = [&](std::size_t row, std::size_t p) {
    return std::ptrdiff_t(p) * std::ptrdiff_t(fractions) + std::ptrdiff_t(row) - 1;
  };
  for (std::size_t row = 0; row < rows; ++row)
    for (std::size_t p = 0; p < length_; ++p) {
      rows_[row * length_ + p] = at(fine(row, p));
      peak_ = std::max(peak_, std::abs(rows_[row * length_ + p]));
    }
  // Linear interpolation deviates by an eighth of the second difference. Differences across a break do not
  // count.
  double bend = 0;
  for (std::size_t row = 1; row + 1 < rows; ++row)
    for (std::size_t p = 0; p < length_; ++p) {
      if (fine(row, p) < 1 || fine(row, p) >= last) continue;
      bend = std::max(bend, std::abs(rows_[(row - 1) * length_ + p] - 2.0 * rows_[row * length_ + p] +
                                     rows_[(row + 1) * length_ + p]));
    }
  by_cubics_ = bend / 8 > tolerance / 4 * peak_;
}

}  // namespace tubefoot
