// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/signal/baseband_pulse.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "engine/relief/fourier.hpp"

namespace tubefoot {

BasebandPulse gaussian_pulse(double sigma_s, double left_out) {
  if (!(sigma_s > 0 && left_out > 0 && left_out < 1))
    throw std::invalid_argument(fmt::format(
        "a Gaussian pulse needs a length above 0 and a part below 1 that is left out, not {} s and {}",
        sigma_s, left_out));
  const double reach = std::sqrt(-2 * std::log(left_out)),
               peak = 1 / std::sqrt(sigma_s * std::sqrt(std::numbers::pi));
  return {[=](double t) { return std::complex<double>(peak * std::exp(-t * t / (2 * sigma_s * sigma_s))); },
          -reach * sigma_s, reach * sigma_s, reach / (std::numbers::pi * sigma_s)};
}

double weighed_bandwidth_hz(const BasebandPulse& pulse, int order) {
  constexpr int frequencies = 128;
  // Four times as often as the band asks for: what is beyond comes back nowhere near it.
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
  constexpr double farthest = 8;   // in halves of the bandwidth
  constexpr double margin = 1.25;  // what lies beyond comes back outside of what is looked at
  constexpr std::size_t least_samples = 1024;
  const double reach_hz = farthest * pulse.bandwidth_hz / 2, rate_hz = 2 * margin * reach_hz;
  const auto held = std::size_t(std::ceil((pulse.end_s - pulse.begin_s) * rate_hz)) + 1;
  const std::size_t count = std::bit_ceil(std::max(2 * held, least_samples));
  std::vector<std::complex<long double>> spectrum(count);
  for (std::size_t k = 0; k < held; ++k) spectrum[k] = pulse.at(pulse.begin_s + double(k) / rate_hz);
  InverseTransforms(count).column(spectrum.data());
  const auto energy = [&](std::size_t n) { return std::norm(std::complex<double>(spectrum[n])); };
  std::vector<double> energies{energy(0)};  // of f and -f
  for (std::size_t n = 1; n < count / 2 && double(n) / double(count) * rate_hz <= reach_hz; ++n)
    energies.push_back(energy(n) + energy(count - n));
  const double all = std::reduce(energies.begin(), energies.end());
  if (!(all > 0)) return pulse.bandwidth_hz;
  const double most = 4 / (tolerance * tolerance), step = rate_hz / double(count);
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
    throw std::invalid_argument(fmt::format(
        "a pulse needs an envelope, an end after its begin and a bandwidth above 0, not {} s to {} "
        "s and {} Hz",
        pulse.begin_s, pulse.end_s, pulse.bandwidth_hz));
  if (times.count < 1 || !(times.rate_hz > 0) || !std::isfinite(times.rate_hz) ||
      !std::isfinite(times.first_s))
    throw std::invalid_argument(
        fmt::format("a receiver needs a sampling rate above 0 and one sample or more, not {} Hz and {}",
                    times.rate_hz, times.count));
  if (pulse.bandwidth_hz > times.rate_hz)
    throw std::invalid_argument(
        fmt::format("a bandwidth of {} Hz does not fit into {} complex samples a second: sample faster, or "
                    "filter the pulse",
                    pulse.bandwidth_hz, times.rate_hz));
}

PulseTable::PulseTable(const BasebandPulse& pulse, const SignalTimes& times)
    : times_(times),
      begin_s_(pulse.begin_s),
      length_(std::size_t(std::ceil((pulse.end_s - pulse.begin_s) * times.rate_hz)) + 1) {
  const auto rows = std::size_t(fractions) + 1;
  rows_.resize((rows + 1) * length_);
  for (std::size_t row = 0; row < rows; ++row)
    for (std::size_t p = 0; p < length_; ++p)
      rows_[row * length_ + p] =
          pulse.at(pulse.begin_s + (double(p) + double(row) / fractions) / times.rate_hz);
}

}  // namespace tubefoot
