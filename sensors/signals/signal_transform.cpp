// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/signals/signal_transform.hpp"

#include <bit>
#include <stdexcept>

namespace tubefoot {
namespace {

using Complex = std::complex<double>;
using Long = std::complex<long double>;

std::size_t power_of_two(std::size_t length) {
  if (length > std::size_t{1} << 26)  // 2 GB
    throw std::invalid_argument("a spectrum has at most 2^26 samples: use shorter records");
  return std::bit_ceil(length == 0 ? std::size_t{1} : length);
}

}  // namespace

SignalTransform::SignalTransform(std::size_t length) : length_(power_of_two(length)), transforms_(length_) {}

std::vector<Complex> SignalTransform::spectrum(std::span<const Complex> signal) const {
  if (signal.size() > length_) throw std::invalid_argument("the signal is longer than its spectrum");
  std::vector<Long> bins(length_);
  for (std::size_t k = 0; k < signal.size(); ++k) bins[k] = Long(signal[k]);
  transforms_.column(bins.data());
  return {bins.begin(), bins.end()};
}

std::vector<Complex> SignalTransform::signal(std::span<const Complex> spectrum) const {
  if (spectrum.size() != length_)
    throw std::invalid_argument("the length of the spectrum differs from that of the transform");
  std::vector<Long> bins;
  bins.reserve(length_);
  for (const Complex& bin : spectrum) bins.emplace_back(std::conj(bin));
  transforms_.column(bins.data());
  std::vector<Complex> signal;
  signal.reserve(length_);
  for (const Long& value : bins) signal.emplace_back(std::conj(value / static_cast<long double>(length_)));
  return signal;
}

double SignalTransform::frequency_hz(std::size_t bin, double rate_hz) const {
  const auto signed_bin = static_cast<double>(bin) - (2 * bin < length_ ? 0 : static_cast<double>(length_));
  return signed_bin * rate_hz / static_cast<double>(length_);
}

}  // namespace tubefoot
