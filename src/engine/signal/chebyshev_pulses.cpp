// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/signal/chebyshev_pulses.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <memory>
#include <utility>

#include "engine/relief/fourier.hpp"

namespace tubefoot {
namespace {

/// Values in the bandwidth's time, of filtered pulses: six of them interpolate to some 3e-7.
constexpr double oversampling = 16;
/// What a filter may spread a pulse by on either side, in times of 1 / bandwidth.
constexpr double spread = 32;

/// Even steps, 0 outside.
struct Sampled {
  double begin_s = 0, rate_hz = 0;
  std::vector<std::complex<double>> value;

  std::complex<double> at(double time_s) const {
    const double place = (time_s - begin_s) * rate_hz, whole = std::floor(place), x = place - whole;
    // Lagrange's polynomial through the values at -2 .. 3.
    const std::array<double, 6> away{x + 2, x + 1, x, x - 1, x - 2, x - 3};
    constexpr std::array<double, 6> product{-120, 24, -12, 12, -24, 120};
    std::complex<double> sum = 0;
    for (std::size_t k = 0; k < 6; ++k) {
      const auto n = std::ptrdiff_t(whole) + std::ptrdiff_t(k) - 2;
      if (n < 0 || n >= std::ptrdiff_t(value.size())) continue;
      double weight = 1 / product[k];
      for (std::size_t m = 0; m < 6; ++m)
        if (m != k) weight *= away[m];
      sum += weight * value[std::size_t(n)];
    }
    return sum;
  }
};

}  // namespace

ChebyshevPulses::ChebyshevPulses(const BasebandPulse& pulse, const SignalTimes& times, int most,
                                 double left_out)
    : pulse_(pulse), times_(times), left_out_(left_out), tables_(std::size_t(most)) {}

const PulseTable& ChebyshevPulses::table(int order) const {
  Table& entry = tables_[std::size_t(order)];
  std::call_once(entry.once, [&] { entry.table.emplace(filtered(order), times_); });
  return *entry.table;
}

BasebandPulse ChebyshevPulses::filtered(int order) const {
  if (order == 0) return pulse_;
  const double rate = oversampling * pulse_.bandwidth_hz,
               begin = pulse_.begin_s - spread / pulse_.bandwidth_hz,
               end = pulse_.end_s + spread / pulse_.bandwidth_hz;
  const std::size_t count = std::bit_ceil(std::size_t(std::ceil((end - begin) * rate)) + 1);
  std::vector<std::complex<long double>> z(count);
  double peak = 0;
  for (std::size_t n = 0; n < count; ++n) {
    const std::complex<double> g = pulse_.at(begin + double(n) / rate);
    peak = std::max(peak, std::abs(g));
    z[n] = g;
  }
  // Of both signs, one is the other's of conjugates: e^{+i omega t} to frequencies, as time goes with
  // e^{-i omega t}.
  const InverseTransforms transform(count);
  transform.column(z.data());
  for (std::size_t n = 0; n < count; ++n) {
    const double turns = double(n) / double(count), frequency = (turns < 0.5 ? turns : turns - 1) * rate,
                 x = std::clamp(2 * frequency / pulse_.bandwidth_hz, -1.0, 1.0);
    double before = 1, value = x;  // T_0, T_1
    for (int j = 1; j < order; ++j) before = std::exchange(value, 2 * x * value - before);
    z[n] = std::conj(z[n]) * (long double)(value / double(count));
  }
  transform.column(z.data());
  std::size_t first = 0, last = count - 1;
  const double faint = left_out_ * peak;
  while (first < last && std::abs(std::complex<double>(z[first])) <= faint) ++first;
  while (last > first && std::abs(std::complex<double>(z[last])) <= faint) --last;
  auto sampled = std::make_shared<Sampled>();
  sampled->begin_s = begin + double(first) / rate;
  sampled->rate_hz = rate;
  for (std::size_t n = first; n <= last; ++n) sampled->value.push_back(std::conj(std::complex<double>(z[n])));
  BasebandPulse filtered = pulse_;
  filtered.begin_s = sampled->begin_s;
  filtered.end_s = begin + double(last) / rate;
  filtered.envelope = [sampled](double time_s) { return sampled->at(time_s); };
  return filtered;
}

}  // namespace tubefoot
